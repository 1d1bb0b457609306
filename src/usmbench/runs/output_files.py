"""Files that a command is asked to write: whole or not at all, with a mend where that fails."""

import errno
import os
from pathlib import Path

from usmbench.errors import InputError
from usmbench.runs.files import replace_file

_MENDS = {
    errno.ENOSPC: "free some space",
    errno.EDQUOT: "free some space",
    errno.EFBIG: "raise the limit on the size of files",
    errno.EISDIR: "it is a folder; name a file",
    errno.EROFS: "give a file where you may write",
    errno.EACCES: "give a file where you may write",
    errno.EPERM: "give a file where you may write",
    errno.ELOOP: "it is a link that leads back to itself; name another file",
    errno.ENAMETOOLONG: "give a shorter name",
}


def write_output(path: Path, content: str | bytes) -> None:
    """Write a file; one that is there stays as it is until the new one is whole.

    Parameters
    ----------
    path
        The file. A device or a pipe is written to as it is.
    content
        Bytes, or text, which is written as UTF-8.

    Raises
    ------
    usmbench.errors.InputError
        The file cannot be written.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(data)
        else:
            replace_file(real_path(path), data)
    except OSError as error:
        raise cannot_write(path, error) from error


def escaped(text: str) -> str:
    """Return text with JSON's escape for each byte of a file name that is not UTF-8.

    Parameters
    ----------
    text
        Such as the name of a run.
    """
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def real_path(path: Path) -> Path:
    """Return where a file to be written lies, links followed.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    OSError
        It is a link that leads back to itself.
    """
    real = Path(os.path.realpath(path))
    if real.is_symlink():  # Path.resolve raises RuntimeError there
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
    return real


def cannot_write(path: Path, error: OSError) -> InputError:
    """Return what the user is told where a file cannot be written.

    Parameters
    ----------
    path
        The file.
    error
        What the system said.
    """
    mend = _MENDS.get(error.errno or 0, "give a file in a folder that exists")
    return InputError(f"cannot be written ({error.strerror or error}); {mend}", file=path)
