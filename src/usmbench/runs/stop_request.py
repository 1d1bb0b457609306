"""A wish to stop, from another process: a file in the run folder.

A file can only ever stop the run whose folder it lies in; a signal to a recorded process id could
reach whatever has that id by now.
"""

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

from usmbench.errors import InputError

STOP_FILE: Final = "stop-request"
LOOK_EVERY_S: Final = 0.25
STOPPED_BY_REQUEST: Final = "stopped by a stop request, as from the live page"


def request_stop(folder: Path) -> None:
    """Ask the process that measures a run to switch the drive off and close the run.

    Parameters
    ----------
    folder
        The run folder.

    Raises
    ------
    usmbench.errors.InputError
        The request cannot be written.
    """
    path = folder / STOP_FILE
    # Never through a link that somebody else has laid: the request stays in its folder.
    flags = os.O_WRONLY | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
    try:
        os.close(os.open(path, flags, 0o644))
    except OSError as error:
        raise InputError(
            f"the stop request cannot be written: {error.strerror}; press Ctrl-C where the sweep "
            "runs, or cut the power of the amplifiers",
            file=path,
        ) from error


def forget_stop_request(folder: Path) -> None:
    """Remove a request that was taken, or that no process is left to take.

    Parameters
    ----------
    folder
        The run folder.

    Raises
    ------
    OSError
        It cannot be removed.
    """
    (folder / STOP_FILE).unlink(missing_ok=True)


class StopSign:
    """Looks for a request, seldom enough that it costs a sweep nothing.

    Parameters
    ----------
    folder
        The run folder.
    clock
        Seconds on the clock on the wall.
    """

    def __init__(self, folder: Path, clock: Callable[[], float] = time.monotonic):
        self._path = folder / STOP_FILE
        self._clock = clock
        self._next_s = clock()

    def check(self) -> None:
        """Stop where that is wanted; looks at most four times a second.

        Raises
        ------
        KeyboardInterrupt
            A request lies in the folder.
        """
        now_s = self._clock()
        if now_s < self._next_s:
            return
        self._next_s = now_s + LOOK_EVERY_S
        if self._path.exists():
            raise KeyboardInterrupt(STOPPED_BY_REQUEST)
