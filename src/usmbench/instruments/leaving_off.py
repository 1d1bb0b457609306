"""Leaving a drive off, whatever happened before."""

from collections.abc import Callable
from typing import Final

from usmbench.errors import BenchError, InputError, UsmbenchError
from usmbench.instruments.board_link import DRIVE_STOPS

_ATTEMPTS: Final = 3


def leave_off(
    switch_off: Callable[[UsmbenchError | None], None], error: BaseException | None
) -> None:
    """Switch off, several times if need be; the error under way stays the one that is seen.

    Parameters
    ----------
    switch_off
        Switches off, told what the attempt before failed with.
    error
        The error under way; None for none.

    Raises
    ------
    usmbench.errors.UsmbenchError
        No attempt succeeded, and no other error is under way but that the user stopped.
    """
    failure: UsmbenchError | None = None
    for _ in range(_ATTEMPTS):
        try:
            switch_off(failure)
        except (BenchError, InputError) as problem:
            failure = problem
        else:
            failure = None
            break
    if failure is None:
        return
    if error is None or isinstance(error, KeyboardInterrupt):
        # "Stopped by the user" would claim that the drive is known to be off.
        raise failure
    error.add_note(f"switching the outputs off failed: {failure}; {DRIVE_STOPS}")
