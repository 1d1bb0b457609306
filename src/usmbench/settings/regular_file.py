"""Files that end: a pipe that nobody writes to, or a device, would be read for ever."""

import stat
from pathlib import Path

from usmbench.errors import InputError


def refuse_endless(path: Path) -> None:
    """Refuse a pipe or a device in the place of a file.

    What is not there, or cannot be looked at, is left to whoever opens it.

    Parameters
    ----------
    path
        The path that is to be read.

    Raises
    ------
    usmbench.errors.InputError
        It is neither a file nor a folder.
    """
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise InputError(
            "is a pipe or a device, which may never end; write what it gives to a file", file=path
        )
