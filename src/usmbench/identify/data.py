"""What identification works on: unbroken stretches of samples, each at one operating point."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.runs.record import Record

Array = NDArray[np.float64]
Point = tuple[float | None, float | None]

_GAP = 1.5  # a step of the clock beyond so many windows is a break in the record
_RATE_TOLERANCE = 1e-3
_THIN_BLOCKS, _THIN_ROWS = 20, 500


@dataclass(frozen=True, slots=True)
class Segment:
    """Consecutive samples of one run at one operating point.

    Parameters
    ----------
    phase_deg, speed_rad_s
        Commanded phase and measured speed, shape (n,).
    point
        Index of the operating point.
    run
        Index of the run.
    first_row
        Row of the run at which the segment starts.
    """

    phase_deg: Array
    speed_rad_s: Array
    point: int
    run: int
    first_row: int

    @property
    def n(self) -> int:
        """Number of samples."""
        return self.phase_deg.size

    def part(self, first: int, last: int) -> "Segment":
        """Return some of its samples, without copying them.

        Parameters
        ----------
        first, last
            First sample, and the one after the last.
        """
        rows = slice(first, last)
        return Segment(
            self.phase_deg[rows],
            self.speed_rad_s[rows],
            self.point,
            self.run,
            self.first_row + first,
        )


@dataclass(frozen=True, slots=True)
class Dataset:
    """All samples of all runs.

    Parameters
    ----------
    segments
        The stretches, in the order of runs and time.
    points
        (frequency_hz, torque_nm) of each operating point.
    window_s
        Time step; None for settled pairs.
    run_names
        Names of the runs, for messages and the model file.
    warnings
        What the user ought to know, one sentence each.
    """

    segments: tuple[Segment, ...]
    points: tuple[Point, ...]
    window_s: float | None
    run_names: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    @property
    def n(self) -> int:
        """Number of samples."""
        return sum(segment.n for segment in self.segments)

    def thinned(self, most_rows: int) -> "Dataset":
        """Return unbroken parts of the segments, spread over all of them.

        Parameters
        ----------
        most_rows
            About how many rows to keep; with fewer in all, all are kept.
        """
        if self.n <= most_rows:
            return self
        parts = []
        for segment in self.segments:
            blocks = max(1, min(_THIN_BLOCKS, segment.n * most_rows // (self.n * _THIN_ROWS)))
            length = max(_THIN_ROWS, segment.n * most_rows // (self.n * blocks))
            for k in range(blocks):
                first = k * segment.n // blocks
                parts.append(segment.part(first, min(first + length, segment.n)))
        return replace(self, segments=tuple(parts))

    def phase_deg(self, point: int) -> Array:
        """Return all phases at one operating point.

        Parameters
        ----------
        point
            Index of the operating point.
        """
        return np.concatenate([s.phase_deg for s in self.segments if s.point == point])

    def speed_rad_s(self, point: int) -> Array:
        """Return all speeds at one operating point.

        Parameters
        ----------
        point
            Index of the operating point.
        """
        return np.concatenate([s.speed_rad_s for s in self.segments if s.point == point])


def from_windows(records: Sequence[Record]) -> Dataset:
    """Gather the windows of runs, cut where time jumps or the operating point changes.

    Parameters
    ----------
    records
        The runs.

    Raises
    ------
    InputError
        A value that is no number, runs with different windows, or a phase that never changes.
    """
    points: dict[Point, int] = {}
    segments: list[Segment] = []
    warnings: list[str] = []
    window_s = float(np.median(records[0].window_s))
    for run, record in enumerate(records):
        _check_numbers(record)
        own_s = float(np.median(record.window_s))
        if abs(own_s / window_s - 1.0) > _RATE_TOLERANCE:
            raise InputError(
                f"{record.name} has windows of {1e3 * own_s:g} ms and {records[0].name} of "
                f"{1e3 * window_s:g} ms; identify runs of one window length at a time"
            )
        jumps = np.flatnonzero(np.diff(record.t_s) > _GAP * window_s) + 1
        if jumps.size:
            warnings.append(
                f"{record.name}: time jumps at {jumps.size} rows (first at row {jumps[0]}, "
                f"{record.t_s[jumps[0]]:g} s); the run is cut there"
            )
        cuts = np.unique(np.concatenate([[0], jumps, _changes(record), [record.t_s.size]]))
        for first, last in pairwise(cuts.tolist()):
            point = points.setdefault(_point(record, first), len(points))
            rows = slice(first, last)
            segments.append(
                Segment(record.phase_deg[rows], record.speed_rad_s[rows], point, run, first)
            )
    data = Dataset(
        tuple(segments),
        tuple(points),
        window_s,
        tuple(record.name for record in records),
        tuple(warnings),
    )
    _check_phase(data)
    return data


def from_pairs(records: Sequence[Record]) -> Dataset:
    """Gather the settled pairs of runs, one segment an operating point and run.

    Parameters
    ----------
    records
        The runs; one without pairs contributes its windows, each taken as a pair.

    Raises
    ------
    InputError
        A value that is no number, or a phase that never changes.
    """
    points: dict[Point, int] = {}
    segments: list[Segment] = []
    warnings: list[str] = []
    for run, record in enumerate(records):
        _check_numbers(record)
        phase_deg, speed_rad_s, keys = _pairs_of(record, warnings)
        for key in dict.fromkeys(keys):
            rows = np.array([row for row, other in enumerate(keys) if other == key])
            point = points.setdefault(key, len(points))
            segments.append(Segment(phase_deg[rows], speed_rad_s[rows], point, run, int(rows[0])))
    names = tuple(record.name for record in records)
    data = Dataset(tuple(segments), tuple(points), None, names, tuple(warnings))
    _check_phase(data)
    return data


def _pairs_of(record: Record, warnings: list[str]) -> tuple[Array, Array, list[Point]]:
    """Phases, speeds and operating points of a run's settled pairs."""
    pairs = record.pairs
    if pairs is None or pairs.phase_deg.size == 0:
        warnings.append(f"{record.name}: no settled pairs, every window is taken as one")
        keys = [_point(record, row) for row in range(record.t_s.size)]
        return record.phase_deg, record.speed_rad_s, keys
    whole = (pairs.n_windows >= 1) & np.isfinite(pairs.speed_rad_s)
    if not np.all(whole):
        warnings.append(
            f"{record.name}: {np.count_nonzero(~whole)} dwells without a settled window left out"
        )
    rows = np.flatnonzero(whole)
    keys = [(_known(pairs.frequency_hz[row]), _known(pairs.torque_nm[row])) for row in rows]
    return pairs.phase_deg[rows], pairs.speed_rad_s[rows], keys


def _changes(record: Record) -> NDArray[np.int64]:
    """Rows at which frequency or torque change."""
    known = [c for c in (record.frequency_hz, record.torque_nm) if c is not None]
    changes = [np.flatnonzero(column[1:] != column[:-1]) + 1 for column in known]
    return np.concatenate([*changes, np.empty(0, dtype=np.int64)]).astype(np.int64)


def _point(record: Record, row: int) -> Point:
    """Operating point of a row."""
    columns = (record.frequency_hz, record.torque_nm)
    frequency_hz, torque_nm = (None if c is None else float(c[row]) for c in columns)
    return frequency_hz, torque_nm


def _known(value: np.float64) -> float | None:
    """Return a pair's frequency or torque; NaN stands for one the run does not say."""
    return None if np.isnan(value) else float(value)


def _check_numbers(record: Record) -> None:
    """Refuse what is no number, naming the row."""
    if record.t_s.size == 0:
        raise InputError(f"{record.name}: there is no row")
    for name in ("t_s", "phase_deg", "speed_rad_s", "frequency_hz", "torque_nm"):
        column = getattr(record, name)
        if column is None or np.all(np.isfinite(column)):
            continue
        row = int(np.argmin(np.isfinite(column)))
        raise InputError(
            f"{record.name}: {name} of row {row} is {column[row]}; remove the row or mend it"
        )


def _check_phase(data: Dataset) -> None:
    """Refuse an operating point at which nothing was varied."""
    for index, point in enumerate(data.points):
        phase_deg = data.phase_deg(index)
        if np.ptp(phase_deg) == 0.0:
            raise InputError(
                f"{', '.join(data.run_names)}: the phase is {phase_deg[0]:g}° throughout"
                f"{describe(point)}; a curve needs a run in which the phase changes"
            )


def describe(point: Point) -> str:
    """Return ' at 41000 Hz, 0.1 N·m', or nothing where neither is known.

    Parameters
    ----------
    point
        (frequency_hz, torque_nm).
    """
    frequency_hz, torque_nm = point
    said = [f"{frequency_hz:g} Hz"] if frequency_hz is not None else []
    said += [f"{torque_nm:g} N·m"] if torque_nm is not None else []
    return f" at {', '.join(said)}" if said else ""
