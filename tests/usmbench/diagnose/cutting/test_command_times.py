"""Dwells that are no whole number of windows: found, and no cause is named for them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from known_motor import driven, identified
from tests.usmbench.diagnose.cutting.uneven_dwells import (
    FINE,
    Array,
    commanded_deg,
    dwelling_run,
    known_dwelling,
)
from usmbench.diagnose.cutting.command_times import between_windows, keeps_own_time
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.hammerstein import HammersteinModel


def _changes(phase_deg: Array) -> NDArray[np.int64]:
    return np.flatnonzero(np.diff(phase_deg))


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return known_dwelling()


@given(
    whole=st.integers(2, 15), part=st.floats(0.1, 0.9), begun=st.floats(0.0, 1.0, exclude_max=True)
)
def test_an_even_interval_between_windows_is_seen(whole: int, part: float, begun: float) -> None:
    n = 60 * (whole + 1)
    assert between_windows(_changes(commanded_deg(whole + part, n, begun)[FINE - 1 :: FINE]))
    assert not between_windows(_changes(commanded_deg(whole, n, begun)[FINE - 1 :: FINE]))


@given(seed=st.integers(0, 2**32 - 1), whole=st.integers(2, 15))
def test_lengths_by_chance_are_none(seed: int, whole: int) -> None:
    rng = np.random.default_rng(seed)
    assert not between_windows(np.cumsum(whole + rng.integers(0, 2, 200)))
    assert not between_windows(np.arange(1, 500))


def test_a_square_wave_that_is_set_at_windows_keeps_step(model: HammersteinModel) -> None:
    """Its dwells are 33 or 34 windows, as those of a clock of its own, but each begins at one."""
    phase_deg = 60.0 * np.sign(np.sin(np.arange(2000) * np.pi * 60.5 / 2000.0 + 1e-6))
    ((square,), _), ((own,), _) = (
        cut_runs([record], model, ()) for record in (driven(phase_deg, 17), dwelling_run(3, 33.06))
    )
    assert between_windows(_changes(phase_deg))
    assert not keeps_own_time(square)
    assert keeps_own_time(own)


def test_a_model_of_runs_in_step_judges_such_dwells_alike() -> None:
    assert diagnose([dwelling_run(8)], identified()).verdict == "no_discrepancy"
