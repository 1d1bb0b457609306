"""What identification works on: unbroken stretches of samples, each at one operating point."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Point = tuple[float | None, float | None]


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
        return replace(
            self,
            phase_deg=self.phase_deg[first:last],
            speed_rad_s=self.speed_rad_s[first:last],
            first_row=self.first_row + first,
        )


@dataclass(frozen=True, slots=True)
class FittedRun:
    """A run that a model rests on.

    Parameters
    ----------
    name
        Its folder or file.
    id
        Its id in run.yaml; None for a bare CSV.
    rows
        Number of rows taken from it.
    motor
        Its motor in run.yaml; None where that does not say.
    counts_per_rev
        Counts of one revolution of its encoder; None where run.yaml does not say.
    """

    name: str
    id: str | None
    rows: int
    motor: str | None = None
    counts_per_rev: float | None = None


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
    runs
        The runs, for messages and the model file.
    spans_deg
        Lowest and highest phase of each operating point.
    warnings
        What the user ought to know, one sentence each.
    """

    segments: tuple[Segment, ...]
    points: tuple[Point, ...]
    window_s: float | None
    runs: tuple[FittedRun, ...]
    spans_deg: tuple[tuple[float, float], ...]
    warnings: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Names of the runs, for messages."""
        return ", ".join(run.name for run in self.runs)

    @property
    def n(self) -> int:
        """Number of samples."""
        return sum(segment.n for segment in self.segments)

    def rows(self, point: int) -> int:
        """Return the number of samples at one operating point.

        Parameters
        ----------
        point
            Index of the operating point.
        """
        return sum(segment.n for segment in self.segments if segment.point == point)

    def phase_deg(self, point: int) -> Array:
        """Return all phases at one operating point.

        Parameters
        ----------
        point
            Index of the operating point.
        """
        return np.concatenate([s.phase_deg for s in self.segments if s.point == point])


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
