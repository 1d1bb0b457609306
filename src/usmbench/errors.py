"""Errors a user sees: each says what happened, where, and what to do."""

from pathlib import Path


class UsmbenchError(Exception):
    """Base of every error that reaches the user as one line instead of a traceback."""

    exit_status = 3


class InputError(UsmbenchError):
    """A file, an argument or a setting is wrong; nothing has moved (exit status 2).

    Parameters
    ----------
    message
        What is wrong and how to mend it, one sentence each.
    file
        The file that is wrong, where there is one.
    line
        The line in `file`, counted from 1.
    """

    exit_status = 2

    def __init__(self, message: str, *, file: Path | str | None = None, line: int | None = None):
        place = "" if file is None else f"{file}: " if line is None else f"{file}:{line}: "
        super().__init__(place + message)
        self.file = file
        self.line = line


class CauseError(InputError):
    """A cause that a package of the user's own registers cannot be loaded or is wrong (exit 2)."""


class BenchError(UsmbenchError):
    """The bench failed while in use; the drive has been, or is being, switched off (exit 3)."""


class PortError(BenchError):
    """The serial port cannot be opened, or has gone."""


class BoardError(BenchError):
    """The signal generator board does not answer, or answers what it must not."""


class BoardRefusedError(BoardError):
    """The board understood a command and refused it.

    Parameters
    ----------
    message
        What was refused, why, and what to do.
    reason
        The reason's name in the protocol description.
    """

    def __init__(self, message: str, *, reason: str):
        super().__init__(message)
        self.reason = reason


class BoardResetError(BoardError):
    """The board has restarted since it was identified; its outputs are off."""


class DaqError(BenchError):
    """The data acquisition failed.

    Parameters
    ----------
    message
        What failed and what to do.
    code
        The NI-DAQmx error code, where there is one.
    """

    def __init__(self, message: str, *, code: int | None = None):
        super().__init__(message)
        self.code = code


class NoDataError(DaqError):
    """The card delivered no samples within the deadline."""


class LostCountsError(DaqError):
    """The index pulse shows that encoder counts were lost."""


class InterlockError(BenchError):
    """An interlock stopped the drive.

    Parameters
    ----------
    message
        What was seen, its limit, and what to look at.
    interlock
        The interlock's name, as in the bench file.
    """

    def __init__(self, message: str, *, interlock: str):
        super().__init__(message)
        self.interlock = interlock
