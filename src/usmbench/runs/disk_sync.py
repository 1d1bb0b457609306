"""Rows forced to disk beside the measurement, which a slow disk must not hold up."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Final

from usmbench.errors import BenchError
from usmbench.runs.columns import WINDOWS_FILE
from usmbench.runs.files import sync_error

SYNC_TIMEOUT_S: Final = 60.0
"""Longest that closing a run waits for its disk."""


class DiskSync:
    """Forces what a run has written to disk, on a thread of its own.

    What is asked for while a disk is at work is done once it is ready, all at one go. A window's
    row is then no later for the disk, the board gets its signs of life, and the card's buffer does
    not fill.

    Parameters
    ----------
    sync
        Forces everything written so far to disk.
    folder
        The run folder, for messages.
    """

    def __init__(self, sync: Callable[[], None], folder: Path):
        self._sync = sync
        self._folder = folder
        self._failure: BenchError | None = None
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="run folder")
        self._last: Future[None] | None = None

    @property
    def at_work(self) -> bool:
        """Whether the disk is still taking what it was given."""
        return self._last is not None and not self._last.done()

    def check(self) -> None:
        """Find out whether the disk has taken everything so far.

        Raises
        ------
        usmbench.errors.BenchError
            It has not.
        """
        if self._failure is not None:
            raise self._failure

    def request(self) -> None:
        """Have everything written so far forced to disk, without waiting for it."""
        # One that has not begun yet will find what is written now.
        if self._last is None or self._last.running() or self._last.done():
            self._last = self._worker.submit(self._run)

    def _run(self) -> None:
        try:
            self._sync()
        except BenchError as error:
            self._failure = error

    def finish(self) -> None:
        """Force everything to disk, wait for it, and end the thread.

        Raises
        ------
        usmbench.errors.BenchError
            The disk has failed, or takes longer than `SYNC_TIMEOUT_S`.
        """
        self.request()
        try:
            if self._last is not None:
                self._last.result(SYNC_TIMEOUT_S)
        except TimeoutError:
            slow = OSError(f"the disk has not been ready for {SYNC_TIMEOUT_S:g} s")
            raise sync_error(self._folder / WINDOWS_FILE, slow) from None
        finally:
            self._worker.shutdown(wait=False)
        self.check()
