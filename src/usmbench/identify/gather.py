"""Runs gathered into what identification works on, cut where they are not one piece."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.identify.data import Dataset, FittedRun, Point, Segment, describe
from usmbench.identify.like_phases import merged_deg
from usmbench.identify.one_way import check_one_way
from usmbench.identify.wild_rows import WILD_TIMES, wild_rows
from usmbench.runs.check_record import changed_since_closed, check_numbers, check_together
from usmbench.runs.columns import DRIVE_COLUMN
from usmbench.runs.doubtful_units import doubtful_units
from usmbench.runs.meta import said_numbers
from usmbench.runs.record import Record
from usmbench.runs.time_step import alike, breaks

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_STANDS_RAD_S = 1e-9
_FEWEST_WINDOWS = 50


def from_windows(records: Sequence[Record]) -> Dataset:
    """Gather the driven windows of runs, cut where time jumps or the operating point changes.

    Windows without drive and the warm-up before the first pass are left out, where the run says
    which they are.

    Parameters
    ----------
    records
        The runs.

    Raises
    ------
    InputError
        A value that is no number, runs of different motors, encoders or windows, or of which
        one turns the other way, too few windows that were driven, or too few phases.
    """
    window_s = records[0].usual_window_s
    found: list[tuple[Point, Segment]] = []
    runs: list[FittedRun] = []
    warnings = changed_since_closed(records)
    check_together(records)
    for number, record in enumerate(records):
        check_numbers(record)
        warnings += doubtful_units([record])
        _check_window(record, records[0].name, window_s)
        jumps = breaks(record.t_s, window_s)
        if jumps.size:
            warnings.append(
                f"{record.name}: time jumps at {jumps.size} rows (first at row {jumps[0]}, "
                f"{record.t_s[jumps[0]]:g} s); the run is cut there"
            )
        wild = wild_rows(record)
        if wild.any():
            row = int(np.argmax(wild))
            warnings.append(
                f"{record.name}: {np.count_nonzero(wild)} rows are {WILD_TIMES:g} times as fast as "
                f"nearly all others and left out (first row {row}, "
                f"{record.speed_rad_s[row]:.4g} rad/s)"
            )
        pieces = list(_pieces(record, number, jumps))
        runs.append(_fitted(record, sum(segment.n for _, segment in pieces)))
        found += pieces
        warnings += _points_without_data(record, [point for point, _ in pieces])
    check_one_way(records)
    warnings += _all_taken_as_driven(records)
    return _dataset(found, window_s, runs, warnings)


def from_pairs(records: Sequence[Record]) -> Dataset:
    """Gather the settled pairs of runs, one segment an operating point and run.

    Parameters
    ----------
    records
        The runs; one without pairs contributes its windows, each taken as a pair.

    Raises
    ------
    InputError
        A value that is no number, a run that turns the other way than others, no settled pair, or
        too few phases.
    """
    found: list[tuple[Point, Segment]] = []
    runs: list[FittedRun] = []
    warnings = changed_since_closed(records)
    check_together(records)
    for number, record in enumerate(records):
        check_numbers(record)
        warnings += doubtful_units([record])
        phase_deg, speed_rad_s, keys = _pairs_of(record, warnings)
        for key in dict.fromkeys(keys):
            rows = np.array([row for row, other in enumerate(keys) if other == key])
            segment = Segment(phase_deg[rows], speed_rad_s[rows], 0, number, int(rows[0]))
            found.append((key, segment))
        runs.append(_fitted(record, len(keys)))
        warnings += _points_without_data(record, keys)
    check_one_way(records)
    return _dataset(found, None, runs, warnings)


def _dataset(
    found: Sequence[tuple[Point, Segment]],
    window_s: float | None,
    runs: Sequence[FittedRun],
    warnings: Sequence[str],
) -> Dataset:
    """Give the operating points their numbers, and refuse one at which nothing was varied."""
    if not found:
        rows = "settled pair" if window_s is None else "window that was driven"
        raise InputError(f"{', '.join(run.name for run in runs)}: there is no {rows}")
    points: dict[Point, int] = {}
    for point, _ in found:
        points.setdefault(point, len(points))
    merged = merged_deg([segment.phase_deg for _, segment in found])
    segments = tuple(
        replace(segment, phase_deg=phase_deg, point=points[point])
        for (point, segment), phase_deg in zip(found, merged, strict=True)
    )
    if max(float(np.max(np.abs(segment.speed_rad_s))) for segment in segments) < _STANDS_RAD_S:
        raise InputError(
            f"{', '.join(run.name for run in runs)}: the motor never moved; is the encoder "
            "connected, and was the drive on?"
        )
    spans_deg = []
    for point, index in points.items():
        own = [segment.phase_deg for segment in segments if segment.point == index]
        low_deg = min(float(phase_deg.min()) for phase_deg in own)
        high_deg = max(float(phase_deg.max()) for phase_deg in own)
        if low_deg == high_deg:
            raise InputError(
                f"{', '.join(run.name for run in runs)}: the phase is {low_deg:g}° throughout"
                f"{describe(point)}; a curve needs a run in which the phase changes"
            )
        if not any(np.any((low_deg < p_deg) & (p_deg < high_deg)) for p_deg in own):
            raise InputError(
                f"{', '.join(run.name for run in runs)}: the phase is {low_deg:g}° or {high_deg:g}°"
                f"{describe(point)} and never between; a curve needs three phases at least"
            )
        spans_deg.append((low_deg, high_deg))
    n = sum(segment.n for segment in segments)
    if window_s is not None and n < _FEWEST_WINDOWS:
        raise InputError(
            f"{', '.join(run.name for run in runs)}: only {n} windows were driven; a curve and its "
            f"dynamics need {_FEWEST_WINDOWS} at least"
        )
    return Dataset(
        segments, tuple(points), window_s, tuple(runs), tuple(spans_deg), tuple(warnings)
    )


def _pieces(
    record: Record, number: int, jumps: NDArray[np.intp]
) -> Iterator[tuple[Point, Segment]]:
    """Unbroken driven stretches of a run at one operating point each."""
    used = _used(record)
    known = [c for c in (record.frequency_hz, record.torque_nm, used) if c is not None]
    changes = [np.flatnonzero(column[1:] != column[:-1]) + 1 for column in known]
    ends = np.array([0, record.t_s.size], dtype=np.intp)
    cuts = np.unique(np.concatenate([ends, jumps, *changes]))
    for first, last in pairwise(cuts.tolist()):
        if used is None or used[first]:
            rows = slice(first, last)
            segment = Segment(record.phase_deg[rows], record.speed_rad_s[rows], 0, number, first)
            yield _point(record, first), segment


def _used(record: Record) -> Mask | None:
    """Rows with the drive on, after the warm-up, and of a speed that may be; None for all."""
    masks = [] if record.driven is None else [record.driven]
    if record.sweep is not None:
        masks.append(record.sweep >= 0.0)
    wild = wild_rows(record)
    if wild.any():
        masks.append(~wild)
    return np.logical_and.reduce(masks) if masks else None


def _all_taken_as_driven(records: Sequence[Record]) -> list[str]:
    """Warn of runs that say of none of their windows whether it was driven, or a warm-up."""
    names = [r.name for r in records if r.driven is None and r.sweep is None]
    if not names:
        return []
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return [
        f"{names[0]}{more}: no column {DRIVE_COLUMN}, every row is taken as driven; rows without "
        "drive, and those of a warm-up, falsify the time constant: mark them by "
        f"{DRIVE_COLUMN} 0 and sweep -1, or remove them"
    ]


def _pairs_of(record: Record, warnings: list[str]) -> tuple[Array, Array, list[Point]]:
    """Phases, speeds and operating points of a run's settled pairs."""
    pairs = record.pairs
    if pairs is None or pairs.phase_deg.size == 0:
        warnings.append(f"{record.name}: no settled pairs, every window is taken as one")
        used = _used(record)
        rows = np.arange(record.t_s.size) if used is None else np.flatnonzero(used)
        keys = [_point(record, row) for row in rows.tolist()]
        return record.phase_deg[rows], record.speed_rad_s[rows], keys
    whole = (pairs.n_windows >= 1) & np.isfinite(pairs.speed_rad_s)
    if not np.all(whole):
        warnings.append(
            f"{record.name}: {np.count_nonzero(~whole)} dwells without a settled window left out"
        )
    rows = np.flatnonzero(whole)
    keys = [(_known(pairs.frequency_hz[row]), _known(pairs.torque_nm[row])) for row in rows]
    return pairs.phase_deg[rows], pairs.speed_rad_s[rows], keys


def _points_without_data(record: Record, found: Sequence[Point]) -> list[str]:
    """Warn of operating points that the run's plan asks for and its rows do not hold."""
    plan = record.meta.get("plan")
    if not isinstance(plan, dict):
        return []
    frequencies_hz = said_numbers(plan.get("frequency_hz"))
    torques_nm = said_numbers(plan.get("torque_nm", 0.0))
    missing = [
        describe((frequency_hz, torque_nm)).removeprefix(" at ")
        for frequency_hz in frequencies_hz
        for torque_nm in torques_nm
        if (frequency_hz, torque_nm) not in found
    ]
    if not missing:
        return []
    return [
        f"{record.name}: the plan asks for {'; '.join(missing)}, and no usable row is there; "
        "the model has no curve for it"
    ]


def _fitted(record: Record, rows: int) -> FittedRun:
    identity = record.meta.get("id")
    own = None if identity is None else str(identity)
    return FittedRun(record.name, own, rows, record.motor, record.counts_per_rev)


def _point(record: Record, row: int) -> Point:
    """Operating point of a row."""
    columns = (record.frequency_hz, record.torque_nm)
    frequency_hz, torque_nm = (None if c is None else float(c[row]) for c in columns)
    return frequency_hz, torque_nm


def _known(value: np.float64) -> float | None:
    """Return a pair's frequency or torque; NaN stands for one the run does not say."""
    return None if np.isnan(value) else float(value)


def _check_window(record: Record, first_name: str, window_s: float) -> None:
    """Refuse a run whose windows differ from the first's."""
    own_s = record.usual_window_s
    if not alike(own_s, window_s):
        raise InputError(
            f"{record.name} has windows of {1e3 * own_s:g} ms and {first_name} of "
            f"{1e3 * window_s:g} ms; identify runs of one window length at a time"
        )
