"""CSV files of other programs, in their dialects."""

import csv
import io
from pathlib import Path

import numpy as np

from usmbench.errors import InputError
from usmbench.runs.record import Column
from usmbench.settings.import_mapping import CsvDialect


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
            if self._decimal == "," and "." in cell:  # of thousands, or a decimal sign after all
                message = (
                    f"{name} is {cell[:40]!r}, with a point, though csv.decimal in the mapping is "
                    'a comma; write numbers without points, or say decimal: "."'
                )
                raise self.error(row, message)
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
