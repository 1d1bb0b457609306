"""What every program of the bench prints: to who may go away, and nothing a terminal obeys."""

import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from typing import TextIO

from usmbench.report.plain_text import printable


def drop_output(stream: TextIO | None = None) -> None:
    """Send what is still to be printed nowhere: whoever read it has gone, or has no room.

    Parameters
    ----------
    stream
        Where it was to be printed; None for standard output.
    """
    stream = sys.stdout if stream is None else stream
    with suppress(OSError, ValueError):
        lost = stream.fileno()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, lost)
        if nowhere != lost:  # as where the stream was closed before
            os.close(nowhere)


def print_or_drop(text: object, stream: TextIO | None = None) -> None:
    """Print a line, if it can be printed.

    Parameters
    ----------
    text
        The line. What is done stays done whether somebody reads of it or not.
    stream
        Where to; None for standard output.
    """
    try:
        print(text, file=stream, flush=True)
    except OSError:
        drop_output(stream)


def complain(text: str) -> None:
    """Print a line to standard error, if it can be printed: the exit status tells the rest.

    Parameters
    ----------
    text
        The line; names from files that others wrote may be in it.
    """
    print_or_drop(printable(text), sys.stderr)


def warn(warnings: Iterable[str]) -> None:
    """Print warnings, one line each.

    Parameters
    ----------
    warnings
        What the user ought to know.
    """
    for warning in warnings:
        complain(f"usmbench: warning: {warning}")
