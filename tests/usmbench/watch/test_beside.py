from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from drifting_motor import WINDOW_S, drifting_motor, paused_run
from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel, LinearPart
from usmbench.model.simulate import simulate
from usmbench.watch.beside import Rows, SimulationBeside
from usmbench.watch.driven_so_far import DrivenSoFar


def rows_of(phase_deg: NDArray[np.float64]) -> Rows:
    n = len(phase_deg)
    nothing = np.full(n, np.nan)
    t_s = 0.01 * np.arange(1.0, n + 1.0)
    frequency_hz, torque_nm = np.full(n, 41_000.0), np.zeros(n)
    return Rows(t_s, phase_deg, 0.1 * phase_deg, frequency_hz, torque_nm, nothing, nothing)


def test_piece_by_piece_it_says_what_one_simulation_says(line_model: HammersteinModel) -> None:
    slow = replace(line_model, linear=LinearPart(np.array([-0.9]), np.array([0.1]), 1, 0.01))
    phase_deg = np.random.default_rng(2).uniform(-90, 90, 3000)
    rows = rows_of(phase_deg)
    beside = SimulationBeside(slow, 0.01, "run")
    pieces = [beside.simulate(rows.part(slice(k, k + 37))) for k in range(0, 3000, 37)]
    whole = simulate(slow, phase_deg, measured_rad_s=rows.speed_rad_s).speed_rad_s
    # What the motor did before the first row is guessed from fewer rows.
    np.testing.assert_allclose(np.concatenate(pieces)[200:], whole[200:], atol=1e-9)


@pytest.mark.parametrize("pauses_s", [(), (3.0,), (300.0,), (7.0, 5.0), (40.0, 3600.0)])
@pytest.mark.parametrize("seed", range(3))
def test_a_run_that_was_paused_looks_as_in_a_replay(seed: int, pauses_s: tuple[float, ...]) -> None:
    """However its rows come in, the motor stands in a pause, and cools."""
    record = paused_run(seed, pauses_s)
    n, rng = record.t_s.size, np.random.default_rng([seed, 1])
    nothing, drive_on = np.full(n, np.nan), record.extra["drive_on"].astype(np.float64)
    columns = (record.t_s, record.phase_deg, record.speed_rad_s)
    rows = Rows(*columns, nothing, nothing, nothing, drive_on)
    beside = SimulationBeside(drifting_motor(), WINDOW_S, "run")
    looks = np.unique(np.r_[0, rng.integers(1, n, 20), np.flatnonzero(drive_on == 0.0)[5:6], n])
    pieces = [beside.simulate(rows.part(slice(a, b))) for a, b in pairwise(looks.tolist())]
    np.testing.assert_allclose(np.concatenate(pieces), record.speed_rad_s, atol=1e-9)


def test_a_drive_that_is_switched_for_ever_takes_no_more_memory() -> None:
    so_far, on = DrivenSoFar(WINDOW_S), np.tile([1.0, 0.0], 5000)
    t_s = WINDOW_S * np.arange(1.0, on.size + 1.0)
    for rows in np.split(np.arange(on.size), 100):
        so_far.add(t_s[rows], on[rows])
    assert so_far.driving.from_s.size <= 2000
    assert so_far.driving.driven_s(t_s[-1:])[0] == pytest.approx(0.5 * t_s[-1])
    assert so_far.driving.warmed(t_s[-1:], 3.0)[0] == pytest.approx(0.5, abs=0.01)


def test_outside_the_models_range_there_is_nothing(line_model: HammersteinModel) -> None:
    speeds = SimulationBeside(line_model, 0.01, "run").simulate(rows_of(np.array([80.0, 100.0])))
    assert speeds[0] == pytest.approx(8.0)
    assert np.isnan(speeds[1])


def test_the_curve_and_the_band_of_a_window(line_model: HammersteinModel) -> None:
    curve = SimulationBeside(line_model, 0.01, "run").curve(41_000.0, float("nan"))
    assert (curve.phase_deg[0], curve.phase_deg[-1]) == (-90.0, 90.0)
    np.testing.assert_allclose(curve.speed_rad_s, curve.phase_deg / 10.0, atol=1e-9)
    assert curve.band_rad_s == pytest.approx(0.196)


def test_windows_of_another_duration_are_refused(line_model: HammersteinModel) -> None:
    with pytest.raises(InputError, match="windows of 20 ms"):
        SimulationBeside(line_model, 0.02, "run")
