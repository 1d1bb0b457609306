"""Columns of files that other programs wrote: CSV in its dialects, MATLAB's .mat."""

import csv
import io
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final, Protocol

import h5py
import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat

from usmbench.errors import InputError
from usmbench.runs.record import Column
from usmbench.settings.import_mapping import CsvDialect

_HDF5_SIGNATURE: Final = b"\x89HDF\r\n\x1a\n"
# MATLAB 7.3 puts its own header before HDF5's signature.
_MAT73_OFFSET: Final = 512
_MAX_VALUES: Final = 500_000_000


class ForeignFile(Protocol):
    """A file with named columns of numbers."""

    @property
    def names(self) -> Sequence[str]:
        """Names of the columns."""

    def column(self, name: str) -> Column:
        """Return a column that there is; InputError where it holds something else than numbers."""

    def error(self, row: int, message: str) -> InputError:
        """Return the error that points at a row, counted from 0."""


def open_foreign(path: Path, dialect: CsvDialect) -> ForeignFile:
    """Open a file of another program: .mat by its name, anything else as CSV.

    Parameters
    ----------
    path
        The file.
    dialect
        How a CSV file is written.

    Raises
    ------
    usmbench.errors.InputError
        It cannot be read, or is not what its name says.
    """
    try:
        if path.suffix.casefold() == ".mat":
            return MatFile(path)
        return CsvFile(path, dialect)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be read: {reason}; check the path", file=path) from error


class CsvFile:
    """A CSV file in memory.

    Parameters
    ----------
    path
        The file.
    dialect
        How it is written.

    Raises
    ------
    usmbench.errors.InputError
        It is not such a file.
    OSError
        It cannot be read.
    """

    def __init__(self, path: Path, dialect: CsvDialect):
        self._path = path
        self._decimal = dialect.decimal
        encoding = "utf-8-sig" if dialect.encoding == "utf-8" else dialect.encoding
        try:
            text = io.StringIO(path.read_bytes().decode(encoding), newline="")
        except UnicodeError as error:
            message = f"is not text in {dialect.encoding}; say csv.encoding in the mapping"
            raise InputError(message, file=path) from error
        for _ in range(dialect.skip_lines):
            text.readline()
        self.names: list[str] = []
        self._cells: list[list[str]] = []
        self._lines: list[int] = []
        reader = csv.reader(text, delimiter=dialect.delimiter, skipinitialspace=True)
        try:
            for row in reader:
                if row:
                    self._take(row, reader.line_num + dialect.skip_lines)
        except csv.Error as error:
            line = reader.line_num + dialect.skip_lines
            raise InputError(f"not CSV: {error}", file=path, line=line) from error
        if not self._cells:
            raise InputError("has no rows under a line of column names", file=path)

    def _take(self, row: list[str], line: int) -> None:
        """Take one row; the first names the columns."""
        if not self.names:
            self.names = [name.strip() for name in row]
            return
        if len(row) != len(self.names):
            raise InputError(
                f"{len(row)} fields where {len(self.names)} columns are named; mend the row, or "
                "the csv section of the mapping",
                file=self._path,
                line=line,
            )
        self._cells.append(row)
        self._lines.append(line)

    def column(self, name: str) -> Column:
        """Return a column as numbers.

        Parameters
        ----------
        name
            One of `names`.

        Raises
        ------
        usmbench.errors.InputError
            It holds something else, or stands twice.
        """
        if self.names.count(name) > 1:
            raise InputError(f"column {name!r} stands twice; rename one", file=self._path)
        place = self.names.index(name)
        values = np.empty(len(self._cells))
        for row, cells in enumerate(self._cells):
            cell = cells[place].strip()
            try:
                # Python's 1_000 is no number in a CSV file.
                values[row] = float(cell.replace("_", "?").replace(self._decimal, "."))
            except ValueError:
                message = f"{name} is {cell[:40]!r}, not a number; mend or remove the row"
                raise self.error(row, message) from None
        return values

    def error(self, row: int, message: str) -> InputError:
        """Return the error that points at a row.

        Parameters
        ----------
        row
            The row, from 0.
        message
            What is wrong there.
        """
        return InputError(message, file=self._path, line=self._lines[row])


class MatFile:
    """The vectors of a MATLAB file; those in a struct have its name before theirs, with a dot.

    Parameters
    ----------
    path
        The file, of any version.

    Raises
    ------
    usmbench.errors.InputError
        It is no such file.
    OSError
        It cannot be read.
    """

    def __init__(self, path: Path):
        self._path = path
        with path.open("rb") as file:
            head = file.read(_MAT73_OFFSET + len(_HDF5_SIGNATURE))
        is_hdf5 = head.startswith(_HDF5_SIGNATURE) or head.endswith(_HDF5_SIGNATURE)
        try:
            found = _hdf5_vectors(path) if is_hdf5 else loadmat(path, simplify_cells=True)
            self._vectors = dict(_vectors(found, ""))
        except Exception as error:
            # A broken file makes SciPy raise almost anything.
            message = f"is no MATLAB file that can be read ({type(error).__name__}); save it again"
            raise InputError(message, file=path) from error

    @property
    def names(self) -> list[str]:
        """Names of the vectors."""
        return list(self._vectors)

    def column(self, name: str) -> Column:
        """Return a vector.

        Parameters
        ----------
        name
            One of `names`.
        """
        return self._vectors[name]

    def error(self, row: int, message: str) -> InputError:
        """Return the error that points at an entry.

        Parameters
        ----------
        row
            The entry, from 0.
        message
            What is wrong there.
        """
        return InputError(f"entry {row + 1}: {message}", file=self._path)


def _vectors(found: dict[str, Any], before: str) -> Iterator[tuple[str, Column]]:
    """Yield what is a vector of numbers, in structs too."""
    for name, value in found.items():
        if isinstance(value, dict):
            yield from _vectors(value, f"{before}{name}.")
        elif isinstance(value, np.ndarray) and _is_vector(value):
            yield before + name, value.reshape(-1).astype(np.float64)


def _is_vector(value: NDArray[Any]) -> bool:
    return value.dtype.kind in "biuf" and value.size > 1 and value.size == max(value.shape)


def _hdf5_vectors(path: Path) -> dict[str, Any]:
    """Return the vectors of a file in version 7.3, by their paths with dots."""
    found: dict[str, Any] = {}

    def take(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "biuf":
            if item.size > _MAX_VALUES:
                raise ValueError(name)
            if item.size > 1 and item.size == max(item.shape):
                found[name.replace("/", ".")] = item[()]

    with h5py.File(path, "r") as file:
        file.visititems(take)
    return found
