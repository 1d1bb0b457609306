"""Dwells that are no whole number of windows: found, and no cause is named for them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from known_motor import CURVE, WINDOW_S, applied, driven, identified
from usmbench.diagnose.cutting.command_times import between_windows, keeps_own_time
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Array = NDArray[np.float64]

FINE = 40  # parts of a window
LEVELS_DEG = np.linspace(-88.0, 88.0, 24)
UP_AND_DOWN_DEG = np.r_[LEVELS_DEG, LEVELS_DEG[-2:0:-1]]


def _phase_deg(dwell_windows: float, n: int, begun: float = 0.0) -> Array:
    """Return the phase at the end of each of n windows, and in each of their parts."""
    into = (np.arange(n * FINE) + 0.5) / FINE + begun * dwell_windows
    phase_deg: Array = UP_AND_DOWN_DEG[(into // dwell_windows).astype(int) % UP_AND_DOWN_DEG.size]
    return phase_deg


def _changes(phase_deg: Array) -> NDArray[np.int64]:
    return np.flatnonzero(np.diff(phase_deg))


def _run(seed: int, dwell_windows: float = 4.37, late_s: float = 0.0) -> Record:
    n, rng = 3000, np.random.default_rng(seed)
    phase_deg = _phase_deg(dwell_windows, n, rng.uniform(0.0, 1.0))
    linear = first_order(0.0035, 0.0015 + late_s, WINDOW_S / FINE)
    speed = free_run(linear, CURVE.speed_rad_s(phase_deg)).reshape(n, FINE).mean(axis=1)
    noisy = speed + 0.0135 * rng.standard_normal(n)
    t_s, window_s = WINDOW_S * np.arange(1.0, n + 1.0), np.full(n, WINDOW_S)
    return Record(f"run {seed}", t_s, phase_deg[FINE - 1 :: FINE], noisy, window_s)


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    run = _run(1)
    return with_knowledge(identify_fast([run], FastOptions()).model, [run])


@given(
    whole=st.integers(2, 15), part=st.floats(0.1, 0.9), begun=st.floats(0.0, 1.0, exclude_max=True)
)
def test_an_even_interval_between_windows_is_seen(whole: int, part: float, begun: float) -> None:
    n = 60 * (whole + 1)
    assert between_windows(_changes(_phase_deg(whole + part, n, begun)[FINE - 1 :: FINE]))
    assert not between_windows(_changes(_phase_deg(whole, n, begun)[FINE - 1 :: FINE]))


@given(seed=st.integers(0, 2**32 - 1), whole=st.integers(2, 15))
def test_lengths_by_chance_are_none(seed: int, whole: int) -> None:
    rng = np.random.default_rng(seed)
    assert not between_windows(np.cumsum(whole + rng.integers(0, 2, 200)))
    assert not between_windows(np.arange(1, 500))


def test_a_square_wave_that_is_set_at_windows_keeps_step(model: HammersteinModel) -> None:
    """Its dwells are 33 or 34 windows, as those of a clock of its own, but each begins at one."""
    phase_deg = 60.0 * np.sign(np.sin(np.arange(2000) * np.pi * 60.5 / 2000.0 + 1e-6))
    ((square,), _), ((own,), _) = (
        cut_runs([record], model, ()) for record in (driven(phase_deg, 17), _run(3, 33.06))
    )
    assert between_windows(_changes(phase_deg))
    assert not keeps_own_time(square)
    assert keeps_own_time(own)


@pytest.mark.parametrize("seed", range(2, 4))
def test_a_healthy_run_of_such_dwells_is_no_swinging_shaft(
    model: HammersteinModel, seed: int
) -> None:
    found = diagnose([_run(seed)], model)
    assert found.verdict == "no_discrepancy"
    assert any("at moments within the windows" in warning for warning in found.warnings)


def test_a_triangle_of_fine_steps_keeps_step() -> None:
    # At its crests a phase is held for two windows, elsewhere for one.
    up_deg, model = np.arange(-88.0, 88.1, 2.2), identified()
    wrong = applied("speed_scale", "", scale_error=-0.024)
    record = driven(np.tile(np.r_[up_deg, up_deg[::-1]], 6), 3, wrong)
    assert not any(keeps_own_time(s) for s in cut_runs([record], model, ())[0])
    found = diagnose([record], model)
    assert "speed_scale" in (found.causes[0].name, *found.causes[0].alternatives)
    assert found.warnings == ()


def test_a_delay_of_two_windows_is_named_still(model: HammersteinModel) -> None:
    (first, *_) = diagnose([_run(7, late_s=2.2 * WINDOW_S)], model).causes
    assert first.name == "transport_delay"
    (delay,) = first.parameters
    assert delay.value == pytest.approx(2.2 * WINDOW_S, rel=0.1)


def test_a_model_of_runs_in_step_judges_such_dwells_alike() -> None:
    assert diagnose([_run(8)], identified()).verdict == "no_discrepancy"
