"""When a motor was driven and how warm that makes it, against a clock of one window's steps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.model.driving import ALWAYS, LOST_S, driving, in_gaps, stops
from usmbench.runs.time_step import breaks

WINDOW_S = 0.01
Array = NDArray[np.float64]


def stepped(power: Array, constant_s: float) -> Array:
    """Return the response of a first-order lag, step by step."""
    kept, warm, found = np.exp(-WINDOW_S / constant_s), 0.0, []
    for p in power.tolist():
        warm = kept * warm + (1.0 - kept) * p
        found.append(warm)
    return np.array(found)


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 2**32 - 1), constant_s=st.floats(0.5, 50.0), switches=st.integers(0, 12))
def test_a_motor_warms_while_it_is_driven_and_cools_in_pauses(
    seed: int, constant_s: float, switches: int
) -> None:
    rng = np.random.default_rng(seed)
    power = np.zeros(3000)
    for at in np.r_[0, rng.integers(0, 3000, switches)]:
        power[at:] = 1.0 - power[at]
    # Of the windows without drive any may be missing, as long as one comes after the gap.
    begin, end = np.sort(rng.integers(1, 2900, 2))
    power[begin : end + 1] = 0.0
    seen = np.r_[0:begin, end:3000]
    t_s = WINDOW_S * (seen + 1.0)
    found = driving(t_s, WINDOW_S, power[seen] > 0.0)
    np.testing.assert_allclose(
        found.warmed(t_s, constant_s), stepped(power, constant_s)[seen], atol=1e-9
    )
    np.testing.assert_allclose(found.driven_s(t_s), WINDOW_S * np.cumsum(power)[seen], atol=1e-9)


def test_a_motor_that_is_always_driven_warms_by_an_exponential() -> None:
    t_s = WINDOW_S * np.arange(1.0, 1000.0)
    for found in (ALWAYS, driving(t_s, WINDOW_S, None), driving(t_s, WINDOW_S, t_s > 0.0)):
        assert found.warmed(t_s, 3.0) == pytest.approx(-np.expm1(-t_s / 3.0))
        assert found.driven_s(t_s) == pytest.approx(t_s)


@pytest.mark.parametrize(
    ("gap_s", "driven", "share"),
    [
        (300.0, None, 0.5),
        (300.0, True, 0.5),
        (300.0, False, 0.0),
        (0.5 * LOST_S, None, 1.0),
        (0.5 * LOST_S, True, 1.0),
        (2.0 * WINDOW_S, False, 0.0),
    ],
)
def test_only_a_row_without_drive_says_that_a_gap_had_none(
    gap_s: float, driven: bool | None, share: float
) -> None:
    t_s = WINDOW_S * np.arange(1.0, 101.0)
    t_s[50:] += gap_s
    known = None if driven is None else np.full(100, True)
    if known is not None:
        known[50:55] = driven
    rows = breaks(t_s, WINDOW_S)
    assert in_gaps(t_s, rows, known).tolist() == [share]
    assert stops(t_s, WINDOW_S, known).tolist() == [50] * (share < 1.0)
    found = driving(t_s, WINDOW_S, known)
    driven_s = float(found.driven_s(t_s[50:51] - WINDOW_S)[0])
    assert driven_s == pytest.approx(0.5 + share * gap_s)
