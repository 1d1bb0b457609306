import math

import numpy as np
import pytest

from hil_sim.ni_server.clock import SampleClock
from hil_sim.signals import Samples


class Ramp:
    """Feed whose position is the number of the sample."""

    def __init__(self) -> None:
        self.taken = 0

    @property
    def time_s(self) -> float:
        return self.taken / 1000.0

    def start(self) -> None:
        """Nothing to do."""

    def stop(self) -> None:
        """Nothing to do."""

    def acquire(self, n_samples: int, sample_rate_hz: float) -> Samples:
        position = np.arange(self.taken, self.taken + n_samples)
        self.taken += n_samples
        return Samples(position, position // 10, float(self.taken))


class Wall:
    def __init__(self) -> None:
        self.time_s = 100.0

    def now_s(self) -> float:
        return self.time_s


def running(*, lock_step: bool) -> tuple[SampleClock, Wall]:
    wall = Wall()
    clock = SampleClock(Ramp(), lock_step=lock_step, now_s=wall.now_s)
    clock.start(1000.0)
    return clock, wall


def test_lock_step_stands_still_until_samples_are_taken() -> None:
    clock, wall = running(lock_step=True)
    wall.time_s += 10.0
    assert clock.due() == 0
    assert clock.wait_s(100) == 0.0
    clock.take(100)
    assert clock.due() == 100
    assert clock.time_s(100) == pytest.approx(0.1)
    assert clock.time_s(0) == pytest.approx(0.0)


def test_real_time_makes_samples_due_with_the_wall_clock() -> None:
    clock, wall = running(lock_step=False)
    assert clock.wait_s(100) == pytest.approx(0.1)
    wall.time_s += 0.0605
    assert clock.due() == 60
    assert clock.wait_s(100) == pytest.approx(0.0395)
    wall.time_s += 0.05
    assert clock.wait_s(100) == 0.0


def test_a_stopped_clock_makes_nothing_due() -> None:
    clock, wall = running(lock_step=False)
    clock.take(10)
    clock.stop()
    wall.time_s += 1.0
    assert clock.due() == 10
    assert clock.wait_s(10) == 0.0
    assert clock.wait_s(11) == math.inf


@pytest.mark.parametrize(("first", "end"), [(0, 10), (10, 25), (3, 7), (5, 40), (0, 60), (59, 60)])
def test_samples_are_cut_from_what_was_taken(first: int, end: int) -> None:
    clock, _ = running(lock_step=True)
    for taken in (10, 25, 60):
        clock.take(taken)
    samples = clock.samples(first, end)
    np.testing.assert_array_equal(samples.position, np.arange(first, end))
    np.testing.assert_array_equal(samples.index_pulses, np.arange(first, end) // 10)
    assert samples.temperature_c == next(t for t in (10.0, 25.0, 60.0) if end <= t)


def test_forgets_whole_chunks_that_nobody_needs() -> None:
    clock, _ = running(lock_step=True)
    for taken in (10, 20, 30):
        clock.take(taken)
    clock.forget(19)
    assert clock.oldest == 10
    np.testing.assert_array_equal(clock.samples(15, 25).position, np.arange(15, 25))
    clock.forget(30)
    assert clock.oldest == 30


def test_catches_up_only_when_it_lags() -> None:
    clock, wall = running(lock_step=False)
    wall.time_s += 0.04
    clock.catch_up(0.05)
    assert clock.taken == 0
    wall.time_s += 0.04
    clock.catch_up(0.05)
    assert clock.taken == 80
