"""One more step over every row, in pieces: the search itself uses no more rows than it needs.

A Gauss-Newton step from a consistent estimate is as good as going on to the minimum (van der Vaart
1998, section 5.7). Each piece's regressors are first multiplied by the inverse triangle of the
search's own regressors. That makes them nearly orthonormal, so their Gram matrix, which is all
that is kept of a piece, is well conditioned whatever the degree, and its factor times the triangle
is the triangle of all rows.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from usmbench.identify.data import Dataset, Segment
from usmbench.identify.design import phase_basis
from usmbench.identify.dynamics import Dynamics, Family
from usmbench.identify.output_error import output_sensitivities
from usmbench.identify.robust import RobustFit, bisquare_root, changing_rows
from usmbench.identify.triangle import full_rank, triangle
from usmbench.model.linear import memory_windows

Array = NDArray[np.float64]

PIECE_ROWS = 16_384
_FORGOTTEN = 1e-10


@dataclass(frozen=True, slots=True)
class Polished:
    """Estimates that rest on every row.

    Parameters
    ----------
    parameters
        Of the dynamics, in their family.
    dynamics
        The linear part.
    delta
        Ordinates of each operating point's curve.
    """

    parameters: Array
    dynamics: Dynamics
    delta: tuple[Array, ...]


def polished(
    data: Dataset, knots_deg: Sequence[Array], family: Family, search: RobustFit
) -> Polished:
    """Take one Gauss-Newton step over all rows.

    Parameters
    ----------
    data
        All samples.
    knots_deg
        Knots of each operating point's curve.
    family
        Of the dynamics.
    search
        The fit to a part of the samples.
    """
    problem, fit = search.problem, search.problem.fit
    step = _Step(family, search)
    reduced, tops = [], []
    for point, prior in enumerate(problem.penalties):
        pieces = (
            piece
            for segment in data.segments
            if segment.point == point
            for piece in _pieces(segment, fit.dynamics)
        )
        factor = step.factor(pieces, knots_deg[point], point)
        n = prior.shape[1]
        still = np.zeros((prior.shape[0], fit.parameters.size))
        growth = np.sqrt(data.n / search.n)
        pulled = growth * np.column_stack([prior, still, -prior @ fit.delta[point]])
        whole = triangle(np.vstack([factor, pulled]))
        tops.append(whole[:n])
        reduced.append(whole[n:, n:])
    left = np.vstack(reduced)
    moved = np.asarray(np.linalg.lstsq(left[:, :-1], left[:, -1], rcond=None)[0], np.float64)
    parameters = family.moved(fit.parameters, moved)
    deltas = []
    for top, delta in zip(tops, fit.delta, strict=True):
        n = delta.size
        corner = full_rank(top[:, :n])
        outcome = top[:, -1] - top[:, n:-1] @ moved
        half = solve_triangular(corner, top[:, :n].T @ outcome, trans="T")
        deltas.append(delta + solve_triangular(corner, half))
    return Polished(parameters, family.dynamics(parameters), tuple(deltas))


@dataclass(frozen=True, slots=True)
class _Piece:
    """Some rows of a segment, after rows that only fill the memory."""

    phase_deg: Array
    speed_rad_s: Array
    skipped: int


def _pieces(segment: Segment, dynamics: Dynamics) -> Iterator[_Piece]:
    """Cut a segment; each piece starts early enough to forget that it was cut."""
    memory = memory_windows(dynamics.linear_part(None), _FORGOTTEN)
    for first in range(memory, segment.n, PIECE_ROWS):
        rows = slice(first - memory, first + PIECE_ROWS)
        yield _Piece(segment.phase_deg[rows], segment.speed_rad_s[rows], memory)


class _Step:
    """Accumulates the rows of one operating point at a time."""

    def __init__(self, family: Family, search: RobustFit) -> None:
        self._search, self._fit = search, search.problem.fit
        self._jacobian = family.jacobian(self._fit.parameters)

    def factor(self, pieces: Iterator[_Piece], knots_deg: Array, point: int) -> Array:
        """Triangle of all rows' regressors with the reduced residual as its last column."""
        guide = full_rank(self._search.problem.point_rows(point))
        size = guide.shape[1]
        scaled = solve_triangular(guide, np.eye(size))
        gram, moment = np.zeros((size, size)), np.zeros(size)
        for piece in pieces:
            rows, residual = self._rows(piece, knots_deg, point)
            near = rows @ scaled
            gram += near.T @ near
            moment += near.T @ residual
        corner = cholesky(gram + 1e-14 * np.trace(gram) * np.eye(size))
        return np.column_stack([corner @ guide, solve_triangular(corner, moment, trans="T")])

    def _rows(self, piece: _Piece, knots_deg: Array, point: int) -> tuple[Array, Array]:
        """Weighted regressors and residual of a piece."""
        fit, dynamics = self._fit, self._fit.dynamics
        basis = phase_basis(piece.phase_deg, knots_deg)
        kept = slice(piece.skipped, None)
        columns = dynamics.respond(basis)
        settled_rad_s = basis @ fit.delta[point]
        slopes = output_sensitivities(dynamics, settled_rad_s - settled_rad_s[0])
        residual = (piece.speed_rad_s - columns @ fit.delta[point])[kept]
        changing = changing_rows(piece.phase_deg, dynamics)[kept]
        scale = np.where(changing, self._search.changing_rad_s, self._search.settled_rad_s)
        weight = bisquare_root(residual / scale) * (self._search.quietest_rad_s / scale)
        rows = np.hstack([columns, slopes @ self._jacobian])[kept] * weight[:, None]
        return rows, residual * weight
