import numpy as np
import pytest

from usmbench.settings.plan import Settle
from usmbench.sweep.settling import Settling

SETTLE = Settle(min_windows=3, over_windows=4, tolerance_rad_s=0.1, relative=0.0)


def counted(settle: Settle | None, speeds: list[float]) -> list[int]:
    settling = Settling(settle)
    return [settling.add(speed) for speed in speeds]


def test_windows_count_from_the_one_after_the_proof() -> None:
    assert counted(SETTLE, [5.0] * 10) == [0] * 7 + [1] * 3


def test_a_drift_puts_it_off_until_it_has_passed() -> None:
    # The halves of the last four windows differ by 0.2 while the ramp of 0.1 goes on.
    ramp = [0.1 * n for n in range(20)]
    assert counted(SETTLE, [*ramp, 1.9, 1.9, 1.9, 1.9]) == [0] * 22 + [1] * 2
    slow = [0.04 * n for n in range(20)]
    assert counted(SETTLE, slow) == [0] * 7 + [1] * 13


def test_the_share_of_the_speed_holds_where_it_is_larger() -> None:
    ramp = [10 + 0.1 * n for n in range(12)]
    assert sum(counted(Settle(3, 4, 0.1, 0.05), ramp)) == 5
    assert sum(counted(Settle(3, 4, 0.1, 0.0), ramp)) == 0


def test_min_windows_alone() -> None:
    assert counted(Settle(2, 0), [1.0, 9.0, 3.0, 7.0]) == [0, 0, 1, 1]


def test_nothing_counts_without_a_criterion() -> None:
    assert counted(None, [1.0] * 5) == [0] * 5


def test_the_pair_is_of_the_settled_windows() -> None:
    rng = np.random.default_rng(4)
    speeds = 8 + 0.01 * rng.standard_normal(500)
    settling = Settling(SETTLE)
    flags = [settling.add(float(speed)) for speed in speeds]
    used = speeds[np.array(flags) == 1]
    mean, deviation, n = settling.pair()
    assert n == len(used) == 493
    assert mean == pytest.approx(used.mean(), rel=1e-12)
    assert deviation == pytest.approx(used.std(ddof=1), rel=1e-9)


def test_a_dwell_that_never_settled_gives_its_last_windows() -> None:
    settling = Settling(SETTLE)
    for n in range(20):
        settling.add(float(n))
    mean, deviation, n = settling.pair()
    assert (mean, n) == (17.5, 4)
    assert deviation == pytest.approx(np.std([16, 17, 18, 19], ddof=1))
    assert settling.n_settled == 0
    assert not settling.is_settled
