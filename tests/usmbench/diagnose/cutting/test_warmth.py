"""How warm a run has made the motor, against what heat capacities say."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.diagnose.cutting.warmth import TIME_CONSTANTS_S, n_constants, warmth
from usmbench.runs.time_step import breaks

WINDOW_S = 0.01
NO_GAP = np.empty(0)


@settings(deadline=None, max_examples=40)
@given(power=st.floats(0.1, 100.0), gap_s=st.floats(0.0, 500.0), at=st.integers(1, 399))
def test_a_steady_power_warms_by_an_exponential_whatever_is_missing(
    power: float, gap_s: float, at: int
) -> None:
    t_s = WINDOW_S * np.arange(1.0, 401.0)
    t_s[at:] += gap_s
    rows = [np.arange(400), np.arange(300, 350)]
    met = np.full(breaks(t_s, WINDOW_S).size, power)
    whole, piece = warmth(t_s, WINDOW_S, [np.full(400, power)], [met], rows)
    for k, constant_s in enumerate(TIME_CONSTANTS_S):
        # Rounding to whole windows where the gap is too short to be one.
        assert whole[0, k] == pytest.approx(-power * np.expm1(-t_s / constant_s), abs=2e-3 * power)
    np.testing.assert_array_equal(piece, whole[:, :, 300:350])


@settings(deadline=None, max_examples=40)
@given(power=st.floats(0.1, 100.0), gap_s=st.floats(0.1, 500.0), at=st.integers(1, 399))
def test_a_motor_that_is_off_in_a_gap_cools_in_it(power: float, gap_s: float, at: int) -> None:
    t_s = WINDOW_S * np.arange(1.0, 401.0)
    t_s[at:] += gap_s
    powers, met, rows = [np.full(400, power)], [np.zeros(1)], [np.arange(400)]
    (warm,) = warmth(t_s, WINDOW_S, powers, met, rows)
    for k, constant_s in enumerate(TIME_CONSTANTS_S):
        before, after = warm[0, k, at - 1 : at + 1]
        kept = np.exp(-WINDOW_S / constant_s)
        cooled = before * np.exp(-gap_s / constant_s)
        assert after == pytest.approx(kept * cooled + (1.0 - kept) * power)


def test_half_a_decade_apart_leaves_little_of_any_constant_between() -> None:
    t_s = 0.1 * np.arange(1.0, 2401.0)
    (basis,) = warmth(t_s, 0.1, [np.ones(t_s.size)], [NO_GAP], [np.arange(t_s.size)])
    columns = np.column_stack([np.ones(t_s.size), *basis[0]])
    for constant_s in np.geomspace(30.0, 1000.0, 9):
        course = -np.expm1(-t_s / constant_s)
        share, *_ = np.linalg.lstsq(columns, course, rcond=None)
        assert np.max(np.abs(columns @ share - course)) < 5e-3


def test_powers_that_alternate_warm_by_their_mean() -> None:
    t_s = WINDOW_S * np.arange(1.0, 20_001.0)
    power = np.where(np.arange(t_s.size) % 2 == 0, 1.0, 3.0)
    powers = [power, np.full(t_s.size, 2.0)]
    (warm,) = warmth(t_s, WINDOW_S, powers, [NO_GAP, NO_GAP], [np.arange(t_s.size)])
    assert warm[0] == pytest.approx(warm[1], abs=2e-3)


@pytest.mark.parametrize(("lasts_s", "n"), [(5.0, 1), (20.0, 2), (60.0, 3), (240.0, 4), (1e5, 5)])
def test_a_run_tells_no_constants_apart_that_are_far_longer(lasts_s: float, n: int) -> None:
    assert n_constants(lasts_s) == n
