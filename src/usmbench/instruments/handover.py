"""Blocks from the driver's callback to the main thread: on demand, in order, errors included."""

import threading
from collections import deque

from usmbench.instruments.samples import SampleBlock


class BlockHandover:
    """A queue whose far end decides how far ahead the callback may read.

    Parameters
    ----------
    read_ahead_blocks
        Blocks that may be read before they are asked for.
    """

    def __init__(self, read_ahead_blocks: int):
        self._changed = threading.Condition()
        self._blocks: deque[SampleBlock] = deque()
        self._error: Exception | None = None
        self._may_read = read_ahead_blocks
        self._demand_unmet = False
        self._stopped = False

    @property
    def stopped(self) -> bool:
        """Whether no block may be read any more."""
        return self._stopped or self._error is not None

    def wait_for_demand(self) -> bool:
        """Wait until a block may be read; False where none may be any more.

        The wait ends with the next demand or with `stop`, one of which always comes.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._may_read > 0 or self.stopped)
            return not self.stopped

    def put(self, block: SampleBlock) -> None:
        """Hand over a block.

        Parameters
        ----------
        block
            The block that was read.
        """
        with self._changed:
            self._may_read -= 1
            self._blocks.append(block)
            self._changed.notify_all()

    def fail(self, error: Exception) -> None:
        """Hand over an error, after which no block is read.

        Parameters
        ----------
        error
            What `take` is to raise once the blocks before it are taken.
        """
        with self._changed:
            self._error = self._error or error
            self._changed.notify_all()

    def take(self, timeout_s: float) -> SampleBlock | None:
        """Ask for the next block and return it, or None where none comes in time.

        Parameters
        ----------
        timeout_s
            Longest wait.

        Raises
        ------
        Exception
            The error handed over by `fail`.
        """
        with self._changed:
            if not self._demand_unmet:
                self._may_read += 1
                self._changed.notify_all()
            self._changed.wait_for(lambda: self._blocks or self.stopped, timeout_s)
            self._demand_unmet = not self._blocks
            if self._blocks:
                return self._blocks.popleft()
            if self._error is not None:
                raise self._error
            return None

    def stop(self) -> None:
        """Let no further block be read, and wake whoever waits."""
        with self._changed:
            self._stopped = True
            self._changed.notify_all()
