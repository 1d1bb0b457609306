"""The testbed's one clock: simulated time follows the wall, or the samples taken."""

import time
from typing import Protocol

from hil_sim.testbed import Testbed


class Clock(Protocol):
    """Says at which simulated time something from outside arrives."""

    @property
    def lock_step(self) -> bool:
        """Whether time stands still between the samples taken."""

    def now_s(self) -> float:
        """Return the simulated time now."""


class LockStep:
    """Simulated time moves with the samples taken, and stands still between.

    Parameters
    ----------
    testbed
        Whose samples count.
    """

    lock_step = True

    def __init__(self, testbed: Testbed):
        self._testbed = testbed

    def now_s(self) -> float:
        """Return the time of the last sample taken."""
        return self._testbed.time_s


class RealTime:
    """Simulated time follows the wall clock, from 0 at construction."""

    lock_step = False

    def __init__(self) -> None:
        self._origin_s = time.monotonic()

    def now_s(self) -> float:
        """Return the seconds since construction."""
        return time.monotonic() - self._origin_s
