"""What a command prints: to somebody who may go away, and nothing that a terminal obeys."""

import os
import sys
from collections.abc import Iterable
from contextlib import suppress

from usmbench.report.plain_text import printable


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


def warn(warnings: Iterable[str]) -> None:
    """Print warnings, one line each.

    Parameters
    ----------
    warnings
        What the user ought to know; names from files that others wrote may be among it.
    """
    for warning in warnings:
        print(printable(f"usmbench: warning: {warning}"), file=sys.stderr)
