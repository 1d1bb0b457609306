"""CSV columns in memory: a fast way for numbers, a careful one for text and for what is wrong."""

import csv
import io
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.runs.plain_numbers import plain_numbers
from usmbench.settings.regular_file import refuse_endless

_MOST_SHOWN = 60  # letters
_TAIL, _FEWEST_ALIKE = 4096, 6  # bytes; rows that tell how many decimals are written

Values = NDArray[np.float64] | NDArray[np.str_]


@dataclass(frozen=True, slots=True)
class Table:
    """The columns of one CSV file.

    Parameters
    ----------
    path
        The file, for messages.
    columns
        Each column by its name, shape (N,); text where a column holds more than numbers.
    """

    path: Path
    columns: Mapping[str, Values]

    def line_of(self, row: int) -> int:
        """Return the line of the file that a row stands in, counted from 1.

        Parameters
        ----------
        row
            Number of the row, from 0.
        """
        reader = csv.reader(io.StringIO(_decoded(self.path, _content(self.path))))
        next(reader)
        rows = (reader.line_num for cells in reader if cells)
        return next(islice(rows, row, None))


def read_table(
    path: Path,
    *,
    needed: Collection[str],
    numbers: Collection[str],
    whole_rows: bool,
    may_be_empty: bool = False,
) -> Table:
    """Read a CSV file with a line of column names.

    Parameters
    ----------
    path
        The file.
    needed
        Columns it must have.
    numbers
        Columns that hold numbers; any other may hold text.
    whole_rows
        Whether a last row without a line end is known to be torn, as in a file that a sweep writes.
        Else it is dropped only where it shows: too few fields, or the beginning of a number, such
        as one with fewer decimals than all before it.
    may_be_empty
        Whether a file without rows will do.

    Raises
    ------
    usmbench.errors.InputError
        The file cannot be read, is not such a table, or has no rows though it must.
    """
    content = _content(path)
    if whole_rows or _is_stump(content):
        content = content[: content.rfind(b"\n") + 1]
    names = _names(path, content, needed)
    table = plain_numbers(content, content.find(b"\n") + 1 or len(content), len(names))
    columns: Mapping[str, Values]
    if table is None:
        columns = _row_by_row(path, _decoded(path, content), names, numbers)
    else:
        columns = dict(zip(names, table, strict=True))
    if not len(columns[names[0]]) and not may_be_empty:
        raise InputError("has no rows; the run stopped before its first", file=path)
    return Table(path, columns)


def has_names(path: Path) -> bool:
    """Return whether a file that a sweep writes is there, with its line of column names whole.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    usmbench.errors.InputError
        It cannot be read.
    """
    return path.exists() and b"\n" in _content(path)


def _content(path: Path) -> bytes:
    """Return what is in the file, without the zeros that a power cut may leave at its end."""
    refuse_endless(path)
    try:
        return path.read_bytes().rstrip(b"\0")
    except OSError as error:
        raise InputError(
            f"cannot be read: {error.strerror}; name a run folder or a CSV file", file=path
        ) from error


def _is_stump(content: bytes) -> bool:
    """Whether the last row has no line end, and fewer decimals than all before it have."""
    rows = content[-_TAIL:].split(b"\n")
    if len(rows) < _FEWEST_ALIKE or not rows[-1]:
        return False
    *before, last = (len(row.strip().rpartition(b",")[2].partition(b".")[2]) for row in rows[1:])
    return last < min(before) == max(before)


def _decoded(path: Path, content: bytes) -> str:
    """Return the content as text."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError("not text in UTF-8; save it as CSV", file=path, line=line) from error


def _names(path: Path, content: bytes, needed: Collection[str]) -> list[str]:
    """Return the column names."""
    head = _decoded(path, content[: content.find(b"\n") + 1 or None]).rstrip("\r\n")
    names = [name.strip() for name in next(csv.reader([head]), [])] if head.isprintable() else []
    missing = [name for name in needed if name not in names]
    if missing:
        raise InputError(
            f"no column {missing[0]!r}; the first line must name the columns, "
            f"separated by commas, {', '.join(needed)} among them{_quoted(head)}"
            f"{_hint(head, names, missing[0])}",
            file=path,
            line=1,
        )
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError(f"column {twice!r} stands twice; rename one", file=path, line=1)
    return names


def _quoted(head: str) -> str:
    """Show what stands in the place of the names."""
    shown = head if len(head) <= _MOST_SHOWN else f"{head[:_MOST_SHOWN]}…"
    return f"; it is {shown!r}" if head else ""


def _hint(head: str, names: list[str], missing: str) -> str:
    """Say how a file comes in whose names are others, or stand elsewhere."""
    for mark, name in ((";", "semicolons"), ("\t", "tabs")):
        if mark in head and "," not in head:
            return f"; these stand between {name}: bring the file in with `usmbench import`"
    for name in names:
        if name.lower() == missing:
            return f"; write {name!r} in small letters"
    if head and (head.startswith("#") or "," not in head):
        return (
            "; remove what stands above the names, or bring the file in with `usmbench import` and "
            "its skip_lines"
        )
    return ""


def _row_by_row(
    path: Path, text: str, names: list[str], numbers: Collection[str]
) -> dict[str, Values]:
    """Return the columns, text among them; say in which line a number is wrong."""
    cells: list[list[str]] = []
    lines: list[int] = []
    reader = csv.reader(io.StringIO(text))
    try:
        next(reader, None)
        for row in reader:
            if row:
                cells.append(row)
                lines.append(reader.line_num)
    except csv.Error as error:
        raise InputError(f"not CSV: {error}", file=path, line=reader.line_num) from error
    if cells and not text.endswith("\n") and _torn(cells[-1], names, numbers):
        cells.pop()
    for row, line in zip(cells, lines, strict=False):
        if len(row) != len(names):
            raise InputError(
                f"{len(row)} fields where the first line names {len(names)}; mend the row",
                file=path,
                line=line,
            )
    columns: dict[str, Values] = {}
    for i, name in enumerate(names):
        values = [row[i].strip() for row in cells]
        columns[name] = _column(path, name, values, lines, is_number=name in numbers)
    return columns


def _torn(row: list[str], names: list[str], numbers: Collection[str]) -> bool:
    """Whether a last row without a line end breaks off: early, or before a number's digits."""
    if len(row) != len(names):
        return len(row) < len(names)
    return names[-1] in numbers and _number(row[-1].strip()) is None


def _column(
    path: Path, name: str, values: list[str], lines: list[int], *, is_number: bool
) -> Values:
    """Return one column, as numbers where it can be."""
    parsed = [_number(value) for value in values]
    if None not in parsed:
        return np.array(parsed, dtype=np.float64)
    if not is_number:
        return np.array(values, dtype=np.str_)
    wrong = parsed.index(None)
    raise InputError(
        f"{name} is {values[wrong][:40]!r}, not a number; mend or remove the row",
        file=path,
        line=lines[wrong],
    )


def _number(text: str) -> float | None:
    """Return the number, None where it is none; Python's 1_000 is no number in a CSV file."""
    try:
        return None if "_" in text else float(text)
    except ValueError:
        return None
