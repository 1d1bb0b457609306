"""The time step of rows whose clock may jitter."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.runs.time_step import UNKNOWN_S, alike, usual_step_s


@given(
    window_s=st.floats(1e-4, 1.0),
    n=st.integers(200, 1000),
    jitter=st.floats(0.0, 0.1),
    gap=st.integers(0, 50),
    seed=st.integers(0, 999),
)
def test_a_clock_that_jitters_or_stops_tells_the_window(
    window_s: float, n: int, jitter: float, gap: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    rows = np.arange(1.0, n + 1.0)
    rows[n // 2 :] += gap
    t_s = window_s * (rows + jitter * rng.uniform(-1.0, 1.0, n))
    # The median of jittering steps may be off by several times this.
    assert usual_step_s(t_s) == pytest.approx(window_s, rel=1e-9 + 4.0 * jitter / n)


@given(window_s=st.floats(1e-4, 1.0), seed=st.integers(0, 999))
def test_clocks_whose_steps_jitter_one_by_one_have_the_same_windows(
    window_s: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    runs = window_s * np.cumsum(1.0 + 0.1 * rng.standard_normal((2, 10_000)), axis=1)
    assert alike(*map(usual_step_s, runs))


@pytest.mark.parametrize("other_s", [0.0099, 0.0101, 0.02])
def test_other_windows_are_others(other_s: float) -> None:
    assert not alike(other_s, 0.01)


def test_a_single_row_tells_nothing() -> None:
    assert usual_step_s(np.array([0.3])) == UNKNOWN_S


def test_a_clock_that_runs_back_is_left_to_the_reader() -> None:
    assert np.isfinite(usual_step_s(np.array([3.0, 2.0, 1.5, 1.0])))
