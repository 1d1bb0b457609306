"""What a rotor does on each row."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.rotor_states import (
    bend_rad_s,
    runs_out,
    steady,
    step_kind,
    turns,
    whole_count_rad_s,
)
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

REVERSING_DEG = np.where(np.arange(400) // 20 % 2, 60.0, -60.0)
PHASE_DEG = np.repeat([30.0, 60.0, 0.0, -60.0, 60.0, 0.0], 20)


def _stretch(model: HammersteinModel, phase_deg: NDArray[np.float64], *own: Applied) -> Stretch:
    n = phase_deg.size
    record = Record("run", 0.01 * np.arange(1.0, n + 1.0), phase_deg, np.zeros(n), np.full(n, 0.01))
    (stretch,), _ = cut_runs([record], model, own)
    return stretch


def test_a_step_runs_on_or_into_a_stop_or_out_of_one_or_through_it(model: HammersteinModel) -> None:
    assert step_kind(_stretch(model, PHASE_DEG))[::20].tolist() == [0, 0, 1, 2, 3, 1]


def test_a_rotor_runs_out_for_a_few_windows_at_a_phase_at_which_it_stands(
    model: HammersteinModel,
) -> None:
    stretch = _stretch(model, PHASE_DEG)
    assert np.array_equal(turns(stretch), PHASE_DEG != 0.0)
    out = runs_out(stretch)
    assert not out[turns(stretch)].any()
    assert out[40] == 1.0
    assert np.all(np.diff(out[40:60]) <= 0.0)
    assert 0.0 < out[42] < 1.0
    assert out[50] < 1e-6


def test_a_habit_that_takes_speed_is_no_bend_of_the_curve(model: HammersteinModel) -> None:
    phase_deg = np.random.default_rng(1).uniform(-88.0, 88.0, 500)
    sticking = Applied(find_effect("stick_slip", ""), {"lost_rad_s": 0.5, "fades_rad_s": 2.0})
    plain, stuck = _stretch(model, phase_deg), _stretch(model, phase_deg, sticking)
    assert np.max(np.abs(stuck.settled_rad_s - plain.settled_rad_s)) > 0.1
    np.testing.assert_array_equal(bend_rad_s(stuck), bend_rad_s(plain))


def test_a_curve_is_to_be_trusted_at_its_crest(model: HammersteinModel) -> None:
    """A curve that still rises at 90° comes back from there, which is no corner of a dead zone."""
    bend = bend_rad_s(_stretch(model, np.linspace(-90.0, 90.0, 181)))
    assert np.max(bend[[0, 1, -2, -1]]) < 2.0 * np.max(bend[[3, 4, -5, -4]])


def test_the_motor_runs_steadily_from_the_third_window_after_a_reversal_on(
    model: HammersteinModel,
) -> None:
    reversing = _stretch(model, REVERSING_DEG)
    assert np.array_equal(steady(reversing), reversing.use & (reversing.lag >= 3))


def test_speeds_of_whole_counts_tell_the_count_and_one_speed_alone_tells_none(
    model: HammersteinModel,
) -> None:
    reversing = _stretch(model, REVERSING_DEG)
    counts: NDArray[np.float64] = np.arange(REVERSING_DEG.size, dtype=np.float64) % 7.0 - 3.0
    for speed_rad_s, count_rad_s in (
        (0.25 * counts, 0.25),
        (np.random.default_rng(1).uniform(0.0, 9.0, counts.size), 0.0),
        (np.where(counts > 0.0, 5.0, -5.0), 0.0),
    ):
        assert whole_count_rad_s(replace(reversing, speed_rad_s=speed_rad_s)) == count_rad_s
