"""What an interlock ended, failing a little after the suspenders have heard of it."""

import time
from typing import Final

from usmbench.bluesky.status import DeviceStatus
from usmbench.errors import BenchError

# A suspender hears of a tripped interlock first and has this long to suspend the plan; without one
# what is under way then fails.
GRACE_S: Final = 0.5


class LateFailures:
    """What fails when its time has come."""

    def __init__(self) -> None:
        self._failing: list[tuple[float, BenchError, DeviceStatus]] = []

    def add(self, status: DeviceStatus, error: BenchError) -> None:
        """Have something fail later.

        Parameters
        ----------
        status
            What is waited for.
        error
            Why it fails.
        """
        self._failing.append((time.monotonic() + GRACE_S, error, status))

    def end_due(self) -> None:
        """Fail what is due."""
        now_s = time.monotonic()
        due = [failing for failing in self._failing if failing[0] <= now_s]
        self._failing = [failing for failing in self._failing if failing[0] > now_s]
        for _, error, status in due:
            status.end(error)

    def end_all(self, error: BenchError | None) -> None:
        """End all at once.

        Parameters
        ----------
        error
            Why it fails instead; None where it does not.
        """
        waiting = [status for _, _, status in self._failing]
        self._failing.clear()
        for status in waiting:
            status.end(error)
