"""From the columns of somebody else's file to a run."""

from collections.abc import Mapping
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from usmbench.errors import InputError
from usmbench.runs.foreign_files import ForeignFile, open_foreign
from usmbench.runs.reader import LIMITED, first_beyond
from usmbench.runs.record import Column, Record
from usmbench.runs.time_step import usual_step_s
from usmbench.settings.import_mapping import (
    COUNTS,
    UNITS,
    VOLT,
    ForeignColumn,
    ImportMapping,
)
from usmbench.settings.yaml_source import PathInDocument

_OPTIONAL = ("frequency_hz", "torque_nm", "angle_rad", "sweep", "settled", "temperature_c")
_MAY_BE_MISSING = "temperature_c"


@np.errstate(over="ignore", invalid="ignore")  # what overflows is beyond a limit
def read_foreign(file: Path, mapping: ImportMapping) -> Record:
    """Read a file by its mapping.

    Time begins with the first window, whatever the file counts it from. Without a column of the
    speed it is the difference of the angle, and the first row, which has nothing before it, is
    left out.

    Parameters
    ----------
    file
        A CSV file, or .mat.
    mapping
        What its columns are.

    Returns
    -------
    Record
        The run, without pairs.

    Raises
    ------
    usmbench.errors.InputError
        The file does not hold what the mapping says; names the line of the one that is wrong.
    """
    foreign = open_foreign(file, mapping.csv)
    raw = {
        name: _taken(foreign, mapping, ("columns", name, "from"), column.source)
        for name, column in mapping.columns.items()
    }
    extra = {
        name: _taken(foreign, mapping, ("keep", i), name) for i, name in enumerate(mapping.keep)
    }
    _check_lengths(file, raw | extra)
    _check_finite(foreign, raw, mapping)
    n_rows = len(raw["phase_deg"])
    columns = {name: np.full(n_rows, value) for name, value in mapping.constants.items()}
    columns |= {name: _plain(name, raw[name], mapping.columns[name]) for name in raw}
    _check_rising(foreign, columns)
    _add_time(columns)
    columns |= _from_counts(raw, columns, mapping)
    first_row = 0
    if "speed_rad_s" not in columns:
        columns, extra = _differenced(columns, extra)
        first_row = 1
    _check_limits(foreign, columns | extra, first_row)
    return _record(file, columns, extra)


def _taken(
    foreign: ForeignFile, mapping: ImportMapping, place: PathInDocument, name: str
) -> Column:
    """Return a column of the file; where it has none, point at the mapping."""
    if name in foreign.names:
        return foreign.column(name)
    there = ", ".join(foreign.names[:20])
    raise mapping.source.error(place, f"the file has no column {name!r}; it has {there}")


def _check_lengths(file: Path, columns: Mapping[str, Column]) -> None:
    lengths = {len(column) for column in columns.values()}
    if len(lengths) > 1:
        said = ", ".join(f"{name} {len(column)}" for name, column in columns.items())
        raise InputError(f"its vectors differ in length ({said}); cut them alike", file=file)


def _check_finite(foreign: ForeignFile, raw: Mapping[str, Column], mapping: ImportMapping) -> None:
    for name, column in raw.items():
        wrong = np.flatnonzero(~np.isfinite(column))
        if len(wrong) and name != _MAY_BE_MISSING:
            row = int(wrong[0])
            source = mapping.columns[name].source
            message = f"{source} is {column[row]}; mend or remove the row"
            raise foreign.error(row, message)


def _plain(name: str, raw: Column, column: ForeignColumn) -> Column:
    """Return a column in the unit of its name; counts stay counts."""
    if column.unit in COUNTS:
        return column.sign * raw
    if column.unit == VOLT:
        value = column.sign * column.per_volt * (raw - column.zero_v)
    else:
        factor, offset = UNITS[name][column.unit]
        value = column.sign * (factor * raw + offset)
    if column.round_to is not None:
        value = column.round_to * np.round(value / column.round_to)
    return value


def _check_rising(foreign: ForeignFile, columns: Mapping[str, Column]) -> None:
    if "t_s" in columns:
        wrong = np.flatnonzero(np.diff(columns["t_s"]) <= 0.0)
        if len(wrong):
            raise foreign.error(int(wrong[0]) + 1, "time does not rise; sort the rows by time")
    if "window_s" in columns:
        wrong = np.flatnonzero(columns["window_s"] <= 0.0)
        if len(wrong):
            raise foreign.error(int(wrong[0]), "a window takes time; mend or remove the row")


def _add_time(columns: dict[str, Column]) -> None:
    """Give every row its window, and the time of the window's end from the first one's start."""
    if "window_s" not in columns:
        columns["window_s"] = np.full(len(columns["t_s"]), usual_step_s(columns["t_s"]))
    if "t_s" not in columns:
        columns["t_s"] = np.cumsum(columns["window_s"])
    else:
        columns["t_s"] = columns["t_s"] - columns["t_s"][0] + columns["window_s"][0]


def _from_counts(
    raw: Mapping[str, Column], columns: Mapping[str, Column], mapping: ImportMapping
) -> dict[str, Column]:
    """Return what is given in counts, in radians."""
    if mapping.counts_per_rev is None:
        return {}
    rad = 2.0 * pi / mapping.counts_per_rev
    found: dict[str, Column] = {}
    for name, column in mapping.columns.items():
        if column.unit not in COUNTS:
            continue
        if name == "angle_rad":
            found[name] = rad * column.sign * _unwrapped(raw[name], mapping.counter_bits)
        else:
            per_s = 1.0 if column.unit == "counts/s" else 1.0 / columns["window_s"]
            found[name] = rad * columns[name] * per_s
    return found


def _unwrapped(counts: Column, counter_bits: int | None) -> Column:
    """Undo the wraps of a counter, and let it begin at 0."""
    steps = np.diff(counts)
    if counter_bits is not None:
        full = float(1 << counter_bits)
        steps -= full * np.round(steps / full)
    unwrapped: Column = np.concatenate(([0.0], np.cumsum(steps)))
    return unwrapped


def _differenced(
    columns: dict[str, Column], extra: dict[str, Column]
) -> tuple[dict[str, Column], dict[str, Column]]:
    """Add the speed that the angle's steps show; every column loses its first row."""
    speed_rad_s = np.diff(columns["angle_rad"]) / np.diff(columns["t_s"])
    if not len(speed_rad_s):
        raise InputError("one row shows no speed; give a file with two or more")
    shorter = {name: column[1:] for name, column in columns.items()}
    shorter["t_s"] = shorter["t_s"] - columns["t_s"][0]
    return shorter | {"speed_rad_s": speed_rad_s}, {name: c[1:] for name, c in extra.items()}


def _check_limits(foreign: ForeignFile, columns: Mapping[str, Column], first_row: int) -> None:
    """Refuse what no reader of the run would take."""
    for name in LIMITED:
        beyond = first_beyond(name, columns[name]) if name in columns else None
        if beyond is not None:
            row, message = beyond
            raise foreign.error(first_row + row, message)


def _record(file: Path, columns: dict[str, Column], extra: dict[str, Column]) -> Record:
    optional: dict[str, Any] = {name: columns.get(name) for name in _OPTIONAL}
    return Record(
        name=str(file),
        t_s=columns["t_s"],
        phase_deg=columns["phase_deg"],
        speed_rad_s=columns["speed_rad_s"],
        window_s=columns["window_s"],
        extra=dict(extra),
        **optional,
    )
