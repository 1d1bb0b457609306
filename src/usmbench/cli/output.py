"""Standard output that may go away while a command works."""

import os
import sys
from contextlib import suppress


def drop_output() -> None:
    """Send what is still to be printed nowhere: whoever read it has gone, or has no room."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def print_or_drop(text: object) -> None:
    """Print a line, if it can be printed.

    Parameters
    ----------
    text
        The line. What is done stays done whether somebody reads of it or not.
    """
    try:
        print(text, flush=True)
    except OSError:
        drop_output()
