"""Windows that stand alone, and which cause they speak for."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from usmbench.model.effects.count_glitches import CountGlitches
from usmbench.model.effects.lone_windows import LoneWindows
from usmbench.model.effects.missed_counts import LostNowAndThen

WINDOW_S = 0.01
N = 3000


def _windows(seed: int, count: int, above_rad_s: float, *, too_slow: bool) -> LoneWindows:
    """Return windows of which so many above a speed stand alone."""
    rng = np.random.default_rng(seed)
    speed = rng.uniform(-10.0, 10.0, N)
    hit = rng.choice(np.flatnonzero(np.abs(speed) > above_rad_s), count, replace=False)
    alone = np.zeros(N, dtype=np.bool_)
    alone[hit] = True
    way = -np.sign(speed) if too_slow else rng.choice([-1.0, 1.0], N)
    deviation = 0.01 * rng.standard_normal(N) + 0.6 * way * alone
    return LoneWindows.of_one_run(speed, deviation, alone, WINDOW_S)


def _stray(windows: LoneWindows, lowest_rad_s: float, next_rad_s: float) -> bool:
    """Whether the lone windows from one speed to the next are likelier strays, one in twenty."""
    fast, rates = np.abs(windows.speed_rad_s), []
    for least_rad_s in (lowest_rad_s, next_rad_s):
        among = fast >= least_rad_s
        rates.append(np.mean(windows.alone[among]) * np.where(among, 1.0, 0.05))
    with_it, without_it = (
        float(np.sum(np.log(np.where(windows.alone, rate, 1.0 - rate)))) for rate in rates
    )
    left_out = np.count_nonzero(windows.alone & (fast < next_rad_s))
    # And either way for a stray, too slow for a loss.
    return bool(without_it + left_out * np.log(0.5 / 0.95) > with_it)


@settings(deadline=None, max_examples=25)
@example(seed=8, count=8, above=4.265625, lost=True)
@example(seed=8, count=8, above=3.328125, lost=True)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(8, 200),
    above=st.floats(3.0, 9.0),
    lost=st.booleans(),
)
def test_lost_counts_are_slow_and_fast_windows_alone(
    seed: int, count: int, above: float, lost: bool
) -> None:
    windows = _windows(seed, count, above if lost else 0.0, too_slow=lost)
    glitches, losses = CountGlitches().weigh(windows), LostNowAndThen().weigh(windows)
    assert (losses.log_likelihood > glitches.log_likelihood) == lost
    if lost:
        low, value, high = losses.values["above_rad_s"]
        assert low <= value <= high
        fast = np.abs(windows.speed_rad_s[windows.alone])
        assert value > np.min(fast) - 0.1
        # More are left out only where the rest are likelier without them.
        begins = float(np.min(fast[fast > value]))
        assert begins <= high + 1e-9  # speeds are told apart to that
        assert np.mean(fast < value) <= 0.05 or _stray(windows, float(np.min(fast)), begins)
        assert losses.values["lost_rad_s"][1] == pytest.approx(0.6, abs=0.02)


def test_a_rate_has_an_exact_interval() -> None:
    windows = _windows(1, 30, 0.0, too_slow=False)
    low, value, high = windows.rate_hz(np.ones(N, dtype=np.bool_))
    # 95 % of a Poisson count of 30: 20.24 to 42.83 (tables of Garwood, 1936).
    assert value == pytest.approx(1.0)
    assert low == pytest.approx(20.24 / 30.0, abs=1e-3)
    assert high == pytest.approx(42.83 / 30.0, abs=1e-3)


@pytest.mark.parametrize("count", [6, 11, 40])
def test_the_interval_of_a_size_holds_the_median_of_any_distribution(count: int) -> None:
    draw, every = np.random.default_rng(count), np.ones(count, dtype=np.bool_)
    held = []
    for sizes in draw.exponential(1.0, (2000, count)):
        windows = LoneWindows.of_one_run(np.ones(count), sizes, every, WINDOW_S)
        low, _, high = windows.size_rad_s(every)
        held.append(low <= np.log(2.0) <= high)
    # At least 95 %, and few sizes leave no choice but more.
    assert 0.94 < np.mean(held) < 0.995


def test_nothing_that_stands_alone_speaks_for_no_lost_counts() -> None:
    windows = LoneWindows.of_one_run(np.ones(5), np.zeros(5), np.zeros(5, dtype=np.bool_), WINDOW_S)
    assert LostNowAndThen().weigh(windows).log_likelihood == -np.inf
    assert windows.size_rad_s(np.ones(5, dtype=np.bool_)) == (0.0, 0.0, 0.0)
    assert windows.rate_hz(np.ones(5, dtype=np.bool_))[0] == 0.0
