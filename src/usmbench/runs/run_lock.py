"""One program at a time writes a run: a lock that the system drops when its holder ends or dies.

Not on Windows, which has no such lock.
"""

import os
import sys
from pathlib import Path

from usmbench.errors import InputError
from usmbench.runs.columns import WINDOWS_FILE
from usmbench.runs.files import refuse_links

if sys.platform != "win32":
    import fcntl


def lock(descriptor: int, folder: Path) -> None:
    """Lock a run for as long as its windows.csv is open.

    Parameters
    ----------
    descriptor
        The open windows.csv.
    folder
        The run folder, for the message.

    Raises
    ------
    usmbench.errors.InputError
        Another program writes the run.
    """
    if sys.platform == "win32":
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise InputError(
            "another program writes this run, such as a sweep that is under way; wait for its end, "
            "or stop it, and resume then",
            file=folder,
        ) from error
    except OSError:
        return  # a file system that has no locks


def check_free(folder: Path) -> None:
    """Refuse a run that another program writes, before anything is opened for it.

    Parameters
    ----------
    folder
        The run folder.

    Raises
    ------
    usmbench.errors.InputError
        Another program writes the run, or a data file is a link or cannot be opened.
    """
    refuse_links(folder)
    path = folder / WINDOWS_FILE
    try:
        descriptor = os.open(path, os.O_RDWR)
    except FileNotFoundError:
        return
    except OSError as error:
        raise InputError(
            f"cannot be opened for writing: {error.strerror}; make it writable", file=path
        ) from error
    try:
        lock(descriptor, folder)
    finally:
        os.close(descriptor)
