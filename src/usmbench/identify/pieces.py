"""A model's free run over any number of rows, a piece at a time.

A piece starts early enough to forget that it was cut, so nothing but the piece is in memory and
the result is that of the whole run. Where dwells repeat a phase, its curve is evaluated once.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.data import Dataset, Segment
from usmbench.model.bernstein import bernstein_basis
from usmbench.model.hammerstein import LinearPart, StaticCurve
from usmbench.model.inverse_map import bezier_abscissa
from usmbench.model.linear import fitted_start_rad_s, memory_windows

Array = NDArray[np.float64]

PIECE_ROWS = 65_536
_FORGOTTEN = 1e-10


@dataclass(frozen=True, slots=True)
class Piece:
    """Some rows of a segment, after rows that only fill the memory.

    Parameters
    ----------
    phase_deg, speed_rad_s
        Commanded phase and measured speed, shape (n,).
    before
        How many of the rows, at the beginning, belong to the piece before.
    """

    phase_deg: Array
    speed_rad_s: Array
    before: int

    def start_rad_s(self, linear: LinearPart, settled_rad_s: Array) -> float:
        """Return the settled speed before the piece, as far as any of its rows depends on it.

        Parameters
        ----------
        linear
            The dynamics.
        settled_rad_s
            The static curve's output, shape (n,).
        """
        if self.before:
            return float(settled_rad_s[0])
        return fitted_start_rad_s(linear, settled_rad_s, self.speed_rad_s)


@dataclass(frozen=True, slots=True)
class Regressors:
    """The Bernstein basis over a piece, one row for phases that repeat.

    Parameters
    ----------
    basis
        Basis at the first row of every dwell, shape (m, d + 1).
    first
        Those rows, shape (m,).
    length
        Rows of every dwell, shape (m,).
    """

    basis: Array
    first: NDArray[np.intp]
    length: NDArray[np.intp]

    def times(self, delta: Array) -> Array:
        """Return the settled speeds.

        Parameters
        ----------
        delta
            Ordinates of the curve, shape (d + 1,).

        Returns
        -------
        Array
            Shape (n,).
        """
        return np.repeat(self.basis @ delta, self.length)

    def transposed_times(self, column: Array) -> Array:
        """Return the inner products of the basis with a column.

        Parameters
        ----------
        column
            Shape (n,).

        Returns
        -------
        Array
            Shape (d + 1,).
        """
        product: Array = np.add.reduceat(column, self.first) @ self.basis
        return product


def pieces(data: Dataset, linear: LinearPart, point: int) -> Iterator[Piece]:
    """Yield the rows of an operating point.

    Parameters
    ----------
    data
        The samples.
    linear
        The dynamics, which say how much of the past a piece needs.
    point
        Index of the operating point.
    """
    memory = memory_windows(linear, _FORGOTTEN)
    for segment in (s for s in data.segments if s.point == point):
        yield from _of_segment(segment, memory)


def _of_segment(segment: Segment, memory: int) -> Iterator[Piece]:
    for first in range(0, segment.n, PIECE_ROWS):
        before = min(first, memory)
        rows = slice(first - before, first + PIECE_ROWS)
        yield Piece(segment.phase_deg[rows], segment.speed_rad_s[rows], before)


def regressors(phase_deg: Array, knots_deg: Array) -> Regressors:
    """Evaluate the basis where the phase changes.

    Parameters
    ----------
    phase_deg
        Phases within the knots, shape (n,).
    knots_deg
        Knots, shape (d + 1,).
    """
    first = _dwell_starts(phase_deg)
    basis = bernstein_basis(bezier_abscissa(phase_deg[first], knots_deg), knots_deg.size - 1)
    return Regressors(basis, first, np.diff(first, append=phase_deg.size))


def settled_speed_rad_s(phase_deg: Array, curve: StaticCurve) -> Array:
    """Return a curve's settled speeds, each dwell's once.

    Parameters
    ----------
    phase_deg
        Phases, shape (n,).
    curve
        The curve.
    """
    first = _dwell_starts(phase_deg)
    return np.repeat(curve.speed_rad_s(phase_deg[first]), np.diff(first, append=phase_deg.size))


def _dwell_starts(phase_deg: Array) -> NDArray[np.intp]:
    """Rows at which the phase changes, and the first."""
    changed = np.flatnonzero(phase_deg[1:] != phase_deg[:-1]) + 1
    return np.concatenate([[0], changed])
