"""The rows that were appended to a CSV file since the last look."""

import io
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError

Array = NDArray[np.float64]

# What one look reads at most, so that catching up with a long run takes no more memory than this.
CHUNK_BYTES = 1 << 18


class RowTail:
    """Follows a file that grows by whole rows, as a sweep's do.

    Parameters
    ----------
    path
        The file; it may not be there yet.
    wanted
        Columns to be read; one that the file does not have is NaN.
    needed
        Those of them that it must have.
    """

    def __init__(self, path: Path, wanted: Sequence[str], needed: Sequence[str] = ()):
        self.path = path
        self.unreadable_rows = 0
        self._wanted = tuple(wanted)
        self._needed = tuple(needed)
        self._places: list[int | None] | None = None
        self._offset = 0
        self._rest = b""

    def look(self) -> Array:
        """Return the rows that have come, shape (n, number of wanted columns).

        At most `CHUNK_BYTES` are read: where there are many, look again until none come.

        Raises
        ------
        usmbench.errors.InputError
            The file cannot be read, or lacks a column that it must have.
        """
        data = self._rest + self._appended()
        if self._places is None:
            head, line_end, data = data.partition(b"\n")
            if not line_end:
                self._rest = head
                return self._no_rows()
            self._places = self._find(head)
        end = data.rfind(b"\n") + 1
        self._rest = data[end:]
        return self._parsed(data[:end], self._places)

    def _no_rows(self) -> Array:
        return np.empty((0, len(self._wanted)))

    def _appended(self) -> bytes:
        try:
            with self.path.open("rb") as file:
                if self._offset == os.fstat(file.fileno()).st_size:
                    return b""
                file.seek(self._offset)
                data = file.read(CHUNK_BYTES)
        except FileNotFoundError:
            return b""
        except OSError as error:
            raise InputError(
                f"cannot be read: {error.strerror}; name a run folder or a CSV file", file=self.path
            ) from error
        self._offset += len(data)
        return data

    def _find(self, head: bytes) -> list[int | None]:
        """Return where the wanted columns stand."""
        text = head.decode("utf-8-sig", errors="replace")
        names = [name.strip() for name in text.split(",")]
        for name in self._needed:
            if name not in names:
                message = f"no column {name!r}; the first line must name the columns"
                raise InputError(message, file=self.path, line=1)
        return [names.index(name) if name in names else None for name in self._wanted]

    def _parsed(self, data: bytes, places: list[int | None]) -> Array:
        """Return the numbers of whole rows; a row that holds none is passed over and counted."""
        present = [place for place in places if place is not None]
        numbers = _numbers(data, present)
        if numbers is None:
            single = [_numbers(line + b"\n", present) for line in data.splitlines()]
            readable = [row for row in single if row is not None and len(row)]
            self.unreadable_rows += sum(row is None for row in single)
            numbers = np.concatenate(readable) if readable else np.empty((0, len(present)))
        rows = np.full((len(numbers), len(places)), np.nan)
        rows[:, [place is not None for place in places]] = numbers
        return rows


def _numbers(data: bytes, columns: list[int]) -> Array | None:
    """Return the columns of some rows, None where one holds something else."""
    if not data.strip():
        return np.empty((0, len(columns)))
    try:
        return np.loadtxt(io.BytesIO(data), delimiter=",", usecols=columns, comments=None, ndmin=2)
    except ValueError:
        return None
