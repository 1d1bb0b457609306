"""From a run folder or a bare CSV to a `Record`, with what is missing derived."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from usmbench.errors import InputError
from usmbench.runs.check_record import BEYOND_MEASURE
from usmbench.runs.columns import (
    DRIVE_COLUMN,
    PAIR_COLUMNS,
    PAIRS_FILE,
    TEMPERATURE_COLUMN,
    WINDOWS_FILE,
)
from usmbench.runs.csv_table import Table, has_names, read_table
from usmbench.runs.dwells import derive_pairs
from usmbench.runs.meta import changed_files, read_meta, said_window_s
from usmbench.runs.record import Column, Pairs, Record
from usmbench.runs.time_step import UNKNOWN_S, usual_step_s

_CLOCK_S = 1e8  # three years: no run has lasted so long
_HALF_TURN_DEG = 180.0
_NEEDED = ("phase_deg", "speed_rad_s")
_OPTIONAL = ("frequency_hz", "torque_nm", "angle_rad", "sweep", "settled")
_KNOWN = ("t_s", *_NEEDED, "window_s", *_OPTIONAL, TEMPERATURE_COLUMN)
_NUMBERS = (*_KNOWN, DRIVE_COLUMN)
LIMITED = tuple(name for name in _NUMBERS if name != TEMPERATURE_COLUMN)
"""Columns of the windows that `first_beyond` is asked about; a temperature may be missing."""
# What a column may hold, the ends included; 360 for those who count φ from 0.
_LIMITS = {
    "phase_deg": (-360.0, 360.0),
    "frequency_hz": (0.0, BEYOND_MEASURE),
    "settled": (0.0, 1.0),
    DRIVE_COLUMN: (0.0, 1.0),
    "speed_std_rad_s": (0.0, BEYOND_MEASURE),
    "n_windows": (0.0, BEYOND_MEASURE),
    "direction": (-1.0, 1.0),
}


def read_run(path: Path | str) -> Record:
    """Read one run.

    Parameters
    ----------
    path
        A run folder, or a bare CSV file with at least `phase_deg` and `speed_rad_s`.

    Returns
    -------
    Record
        The run. Where the file has none, `window_s` comes from run.yaml's encoder, else from the
        usual step of `t_s`, else it is 0.01 s; `t_s` of a bare CSV adds up the windows, and is
        counted from the first one where it is the time of a clock; the pairs are derived from the
        windows. Phases counted from 0 to 360° come as -180 to 180°.

    Raises
    ------
    usmbench.errors.InputError
        The run cannot be read; the message names the file, the line and the mend.
    """
    path = Path(path)
    if path.is_dir():
        meta = read_meta(path)
        windows, whole = path / WINDOWS_FILE, True
    else:
        meta = {}
        windows, whole = path, False
    needed = ("t_s", *_NEEDED) if whole else _NEEDED
    table = read_table(windows, needed=needed, numbers=_NUMBERS, whole_rows=whole)
    columns = _checked(table, LIMITED)
    window_s = _window_s(table, columns, meta)
    t_s = columns["t_s"] if "t_s" in columns else np.cumsum(window_s)
    _rising(table, t_s)
    if not whole and t_s.size and not 0.0 <= t_s[0] <= _CLOCK_S:
        t_s = t_s - t_s[0] + window_s[0]
    optional = {name: columns.get(name) for name in _OPTIONAL}
    of_dwells = optional | {DRIVE_COLUMN: _as_column(table, DRIVE_COLUMN)}
    pairs = _read_pairs(path / PAIRS_FILE) if whole else None
    return Record(
        name=str(path),
        t_s=t_s,
        phase_deg=columns["phase_deg"],
        speed_rad_s=columns["speed_rad_s"],
        window_s=window_s,
        temperature_c=_as_column(table, TEMPERATURE_COLUMN),
        pairs=pairs or derive_pairs(t_s, columns["phase_deg"], columns["speed_rad_s"], of_dwells),
        meta=meta,
        extra={name: column for name, column in table.columns.items() if name not in _KNOWN},
        changed=_changed(path, meta),
        **optional,
    )


def _changed(folder: Path, meta: dict[str, Any]) -> tuple[str, ...]:
    """Hold what is read against its check sums; raw.h5, which may be large, is not read."""
    sums = meta.get("sha256")
    if not isinstance(sums, dict):
        return ()
    ours = {name: sums[name] for name in (WINDOWS_FILE, PAIRS_FILE) if name in sums}
    return tuple(changed_files(folder, ours))


def _as_column(table: Table, name: str) -> Column | None:
    """Return a column of numbers, None where the table does not have it."""
    column = table.columns.get(name)
    return None if column is None else column.astype(np.float64, copy=False)


def first_beyond(name: str, column: Column) -> tuple[int, str] | None:
    """Return the first row that holds what its column may not, and what is wrong there.

    Parameters
    ----------
    name
        The column's name.
    column
        Its values.
    """
    low, high = _LIMITS.get(name, (-BEYOND_MEASURE, BEYOND_MEASURE))
    wrong = np.flatnonzero(~(np.isfinite(column) & (low <= column) & (column <= high)))
    if not len(wrong):
        return None
    value = column[wrong[0]]
    limits = f", not {low:g} to {high:g}" if math.isfinite(value) else ""
    return int(wrong[0]), f"{name} is {value:.12g}{limits}; mend or remove the row"


def _checked(table: Table, names: Iterable[str]) -> dict[str, Column]:
    """Return those of the columns that the table has, their numbers checked, phases wrapped."""
    columns: dict[str, Column] = {}
    for name in names:
        column = _as_column(table, name)
        if column is None:
            continue
        beyond = first_beyond(name, column)
        if beyond is not None:
            row, message = beyond
            raise InputError(message, file=table.path, line=table.line_of(row))
        columns[name] = _wrapped(column) if name == "phase_deg" else column
    return columns


def _wrapped(phase_deg: Column) -> Column:
    """Return the same phases as all else counts them, from -180° to 180°."""
    beyond = np.abs(phase_deg) > _HALF_TURN_DEG
    return np.where(beyond, phase_deg - 2.0 * _HALF_TURN_DEG * np.sign(phase_deg), phase_deg)


def _rising(table: Table, t_s: Column) -> None:
    """Refuse time that stands still or runs back."""
    wrong = np.flatnonzero(np.diff(t_s) <= 0.0)
    if len(wrong):
        raise InputError(
            f"t_s does not rise ({t_s[wrong[0]]:.12g}, then {t_s[wrong[0] + 1]:.12g}); "
            "sort the rows by time and give each window once",
            file=table.path,
            line=table.line_of(int(wrong[0]) + 1),
        )


def _window_s(table: Table, columns: dict[str, Column], meta: dict[str, Any]) -> Column:
    """Return the duration of each window, from the best source there is."""
    window_s = columns.get("window_s")
    if window_s is None:
        usual_s = said_window_s(meta)
        if usual_s is None:
            usual_s = usual_step_s(columns["t_s"]) if "t_s" in columns else UNKNOWN_S
        window_s = np.full(len(columns["phase_deg"]), usual_s)
    wrong = np.flatnonzero(window_s <= 0.0)
    if len(wrong) and "window_s" in columns:
        raise InputError(
            f"window_s is {window_s[wrong[0]]:.12g}; a window takes time, mend or remove the row",
            file=table.path,
            line=table.line_of(int(wrong[0])),
        )
    return window_s


def _read_pairs(path: Path) -> Pairs | None:
    """Return the pairs of pairs.csv, None where there are none."""
    if not has_names(path):
        return None
    table = read_table(
        path, needed=PAIR_COLUMNS, numbers=PAIR_COLUMNS, whole_rows=True, may_be_empty=True
    )
    columns = _checked(table, PAIR_COLUMNS)
    return Pairs(**columns) if len(columns["t_s"]) else None
