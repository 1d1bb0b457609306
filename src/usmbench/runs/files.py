"""Writing that survives a cut: files replaced in one step, rows appended and forced to disk."""

import errno
import os
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from usmbench.errors import BenchError, InputError
from usmbench.runs.columns import DATA_FILES


def disk_error(path: Path, error: OSError) -> BenchError:
    """Return what the user is told when the run folder cannot be written.

    Parameters
    ----------
    path
        The file that could not be written.
    error
        What the system said.

    Returns
    -------
    usmbench.errors.BenchError
        What happened, what is safe and what to do.
    """
    return _told(path, error, f"every row reported before is safe in {path.parent}")


def sync_error(path: Path, error: OSError) -> BenchError:
    """Return what the user is told when the disk does not keep what it was given.

    Parameters
    ----------
    path
        The file that was being forced to disk.
    error
        What the system said.

    Returns
    -------
    usmbench.errors.BenchError
        What happened, what is safe and what to do.
    """
    return _told(path, error, "rows of the last second may be lost, those before are safe")


def _told(path: Path, error: OSError, safe: str) -> BenchError:
    full = error.errno in (errno.ENOSPC, errno.EDQUOT)
    what = "no space left on the disk" if full else error.strerror or str(error)
    mend = "free some space" if full else "mend the disk"
    return BenchError(
        f"{path}: {what}; {safe}, {mend} and begin again (a sweep goes on by sweep --resume "
        f"{path.parent})"
    )


def sync_folder(folder: Path) -> None:
    """Force a folder's list of files to disk.

    Parameters
    ----------
    folder
        The folder; systems that cannot open folders (Windows) need no such call.
    """
    with suppress(PermissionError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def refuse_links(folder: Path) -> None:
    """Refuse a run whose data files are links: what these lead to would be written to.

    Parameters
    ----------
    folder
        The run folder.

    Raises
    ------
    usmbench.errors.InputError
        A data file is a link.
    """
    for name in DATA_FILES:
        if (folder / name).is_symlink():
            raise InputError("is a link; put the file itself in its place", file=folder / name)


def new_file(path: Path) -> BinaryIO:
    """Open a file to write it anew; what stands in its place, a link too, is removed.

    Parameters
    ----------
    path
        The file; it need not exist.

    Raises
    ------
    OSError
        The file cannot be made.
    """
    path.unlink(missing_ok=True)
    return path.open("xb")


def replace_file(path: Path, content: bytes) -> None:
    """Replace a file so that at any instant either the old or the new one is whole.

    Parameters
    ----------
    path
        The file; it need not exist.
    content
        Its new content.

    Raises
    ------
    OSError
        The new file could not be written; the old one is untouched.
    """
    new = path.with_name(path.name + ".new")
    try:
        with new_file(new) as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        new.replace(path)
    except OSError:
        with suppress(OSError):
            new.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


class AppendedFile:
    """A file that only grows, row by row, each handed to the system at once.

    Parameters
    ----------
    path
        The file; made where it does not exist.

    Raises
    ------
    usmbench.errors.BenchError
        The file cannot be opened, or is a link.
    """

    def __init__(self, path: Path):
        self.path = path
        kind = getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
        try:
            self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | kind, 0o644)
            self._size = os.fstat(self._descriptor).st_size
        except OSError as error:
            raise disk_error(path, error) from error

    @property
    def size(self) -> int:
        """Bytes in the file, all of them whole rows."""
        return self._size

    @property
    def descriptor(self) -> int:
        """The open file."""
        return self._descriptor

    def append(self, rows: bytes) -> None:
        """Append whole rows; what is appended survives the death of this process.

        Parameters
        ----------
        rows
            One or more rows, each with its line end.

        Raises
        ------
        usmbench.errors.BenchError
            The rows could not be written; the file ends with the row before them.
        """
        try:
            written = os.write(self._descriptor, rows)
            while written < len(rows):
                written += os.write(self._descriptor, rows[written:])
        except OSError as error:
            with suppress(OSError):
                os.ftruncate(self._descriptor, self._size)
            raise disk_error(self.path, error) from error
        self._size += written

    def drop_torn_row(self) -> None:
        """Cut what follows the last line end: the rest of a row that a cut interrupted.

        Raises
        ------
        usmbench.errors.BenchError
            The file cannot be read or cut.
        """
        try:
            with self.path.open("rb") as file:
                end = _end_of_rows(file.read())
            os.ftruncate(self._descriptor, end)
        except OSError as error:
            raise disk_error(self.path, error) from error
        self._size = end

    def sync(self) -> None:
        """Force what was appended to disk; it then survives a power cut too.

        Raises
        ------
        usmbench.errors.BenchError
            The system could not.
        """
        try:
            os.fsync(self._descriptor)
        except OSError as error:
            raise sync_error(self.path, error) from error

    def close(self) -> None:
        """Release the file; safe to call twice."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1


def _end_of_rows(content: bytes) -> int:
    """Return where the last whole row ends."""
    return content.rfind(b"\n") + 1
