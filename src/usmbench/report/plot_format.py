"""Which formats a plot may have, told by its file's ending."""

from pathlib import Path

from usmbench.errors import InputError

_FORMATS = ("png", "svg", "pdf")


def plot_format(path: Path) -> str:
    """Return the format that a plot's ending names; a command asks before it begins its work.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    usmbench.errors.InputError
        The ending names none.
    """
    ending = path.suffix.lower().removeprefix(".")
    if ending not in _FORMATS:
        raise InputError("its ending names no format; give a .png, .svg or .pdf", file=path)
    return ending
