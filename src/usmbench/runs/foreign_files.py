"""Files of other programs, by what their names say: CSV, or MATLAB's .mat."""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from usmbench.errors import InputError
from usmbench.runs.foreign_csv import CsvFile
from usmbench.runs.foreign_mat import MatFile
from usmbench.runs.record import Column
from usmbench.settings.import_mapping import CsvDialect
from usmbench.settings.regular_file import refuse_endless


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
        It cannot be read, has no end, or is not what its name says.
    """
    refuse_endless(path)
    try:
        if path.suffix.casefold() == ".mat":
            return MatFile(path)
        return CsvFile(path, dialect)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be read: {reason}; check the path", file=path) from error
