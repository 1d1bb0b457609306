"""From the estimate on a part of the rows to that on every row, in pieces.

The search uses no more rows than it needs; its linearised problem tells the curvature. What is
left is the gradient over all rows, which needs no regressor of a row: with the adjoint of the
dynamics, which runs back in time, the inner products of all filtered regressors with the residual
are those of the plain basis with one filtered residual. A pass costs a few filters a row, whatever
the degree, and two passes are usually enough.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from usmbench.identify.data import Dataset
from usmbench.identify.dynamics import Dynamics, Family
from usmbench.identify.linearised import Linearisation
from usmbench.identify.pieces import PIECE_ROWS, Piece, Regressors, pieces, regressors
from usmbench.identify.robust_fit import RobustFit, bisquare_root, changing_rows
from usmbench.identify.sensitivities import output_sensitivities
from usmbench.identify.triangle import full_rank, triangle
from usmbench.model.linear import free_run, from_rest

Array = NDArray[np.float64]

_MAX_PASSES = 8
_CLOSE = 0.1  # squared distance to the minimum, in standard deviations, over all estimates
_FIRST_SHARE = 0.01  # of a squared distance that the first step may leave
_FAR = 0.2  # of ln τ, of a window, of a coefficient: the search was at its minimum
_SHRINKING = 0.25  # of the squared distance before


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
    data: Dataset,
    knots_deg: Sequence[Array],
    family: Family,
    search: RobustFit,
    linearised: Linearisation,
    priors: Sequence[Array],
) -> Polished:
    """Go on to the minimum over all rows, with the scales that the search came to.

    Parameters
    ----------
    data
        All samples.
    knots_deg
        Knots of each operating point's curve.
    family
        Of the dynamics.
    search
        The fit to these samples or a part of them.
    linearised
        The search's rows near its estimate.
    priors
        Rows of prior knowledge of each operating point's curve, at their share of that part.

    Returns
    -------
    Polished
        Estimates that all together are within a third of a standard deviation of the minimum, or
        those of the last step that was shorter than the one before.
    """
    fit = search.problem.fit
    here = Polished(fit.parameters, fit.dynamics, fit.delta)
    curvature = _Curvature(linearised, priors, data.n)
    few = data.n <= PIECE_ROWS  # every segment is one piece, whatever the dynamics
    kept = list(_pieces(data, knots_deg, here.dynamics)) if few else None
    last = np.inf
    for _ in range(_MAX_PASSES):
        rows = kept or _pieces(data, knots_deg, here.dynamics)
        there, distance = _step(rows, family, search, curvature, here)
        if distance > _SHRINKING * last or not there.dynamics.stable:
            # The curvature is that of another place: take it here.
            nearby = search.problem.at(here.parameters).linearised()
            curvature, last = _Curvature(nearby, priors, data.n), np.inf
            continue
        here = there
        # The next step will be shorter by the same share.
        share = _FIRST_SHARE if last == np.inf else distance / last
        if distance * share < _CLOSE:
            break
        last = distance
    return here


def _pieces(
    data: Dataset, knots_deg: Sequence[Array], dynamics: Dynamics
) -> Iterator[tuple[int, Piece, Regressors]]:
    """Operating point, rows and basis of every piece."""
    for point, knots in enumerate(knots_deg):
        for piece in pieces(data, dynamics.linear_part(None), point):
            yield point, piece, regressors(piece.phase_deg, knots)


def _step(
    rows: Iterable[tuple[int, Piece, Regressors]],
    family: Family,
    search: RobustFit,
    curvature: "_Curvature",
    here: Polished,
) -> tuple[Polished, float]:
    """One Newton step, and its squared length in standard deviations of the estimates."""
    moments = [-curvature.prior_moment(point, delta) for point, delta in enumerate(here.delta)]
    slope = np.zeros(here.dynamics.a.size + here.dynamics.beta.size)
    for point, piece, basis in rows:
        of_curve, of_dynamics = _gradient(piece, basis, here.delta[point], here.dynamics, search)
        moments[point] += of_curve
        slope += of_dynamics
    slope = slope @ family.jacobian(here.parameters)
    moved, deltas = _short_step(family, here.parameters, curvature, moments, slope)
    length = float(slope @ moved) + sum(float(m @ d) for m, d in zip(moments, deltas, strict=True))
    parameters = here.parameters + moved
    there = Polished(
        parameters,
        family.dynamics(parameters),
        tuple(old + step for old, step in zip(here.delta, deltas, strict=True)),
    )
    return there, length / search.quietest_rad_s**2


def _short_step(
    family: Family,
    parameters: Array,
    curvature: "_Curvature",
    moments: Sequence[Array],
    slope: Array,
) -> tuple[Array, list[Array]]:
    """Newton step that holds what would go far, or leave its bounds.

    In windows far longer than the lag, nothing but lag and dead time together is sure: along a
    valley that bends, a long step between the two would end anywhere.
    """
    free = np.ones(slope.size, dtype=np.bool_)
    moved, deltas = curvature.solve(moments, slope, free)
    for _ in slope:
        inside = family.moved(parameters, moved) == parameters + moved
        near = inside & (np.abs(moved) < _FAR)
        if np.all(near):
            break
        free &= near
        moved, deltas = curvature.solve(moments, slope, free)
    return moved, deltas


def _gradient(
    piece: Piece, basis: Regressors, delta: Array, dynamics: Dynamics, search: RobustFit
) -> tuple[Array, Array]:
    """Inner products of a piece's weighted residual with the regressors of curve and dynamics."""
    settled_rad_s = basis.times(delta)
    linear = dynamics.linear_part(None)
    start_rad_s = piece.start_rad_s(linear, settled_rad_s)
    residual = piece.speed_rad_s - free_run(linear, settled_rad_s, start_rad_s)
    changing = changing_rows(piece.phase_deg, dynamics)
    scale = np.where(changing, search.changing_rad_s, search.settled_rad_s)
    root = bisquare_root(residual / scale) * (search.quietest_rad_s / scale)
    influence = residual * root**2
    influence[: piece.before] = 0.0
    back = from_rest(dynamics.numerator, dynamics.a, dynamics.dead_time_windows, influence[::-1])[
        ::-1
    ]
    slopes = output_sensitivities(dynamics, settled_rad_s - start_rad_s)
    return basis.transposed_times(back), influence @ slopes


class _Curvature:
    """Curvature of the sum of squares over all rows, from those of the search.

    Triangular factors, one an operating point: the curve first, the shared dynamics after it.
    """

    def __init__(self, linearised: Linearisation, priors: Sequence[Array], n: int) -> None:
        self._growth = n / linearised.n
        self._priors, self._factors = priors, []
        for prior, factor in zip(priors, linearised.factors, strict=True):
            rows = np.sqrt(linearised.slope) * factor
            still = np.zeros((prior.shape[0], rows.shape[1] - prior.shape[1]))
            self._factors.append(full_rank(rows, np.hstack([prior, still])))

    def prior_moment(self, point: int, delta: Array) -> Array:
        """Gradient of what is known of a curve without data."""
        prior = self._priors[point]
        moment: Array = self._growth * (prior.T @ (prior @ delta))
        return moment

    def solve(
        self, moments: Sequence[Array], slope: Array, free: NDArray[np.bool_]
    ) -> tuple[Array, list[Array]]:
        """Newton step of the free parameters of the dynamics, and of every curve."""
        halves, left = [], slope.copy()
        for factor, moment in zip(self._factors, moments, strict=True):
            n = moment.size
            half = solve_triangular(factor[:n, :n], moment, trans="T")
            halves.append(half)
            left -= factor[:n, n:].T @ half
        n_shared = slope.size
        moved = np.zeros(n_shared)
        if np.any(free):
            corner = triangle(*(f[-n_shared:, -n_shared:][:, free] for f in self._factors))
            moved[free] = solve_triangular(corner, solve_triangular(corner, left[free], trans="T"))
        deltas = []
        for factor, half in zip(self._factors, halves, strict=True):
            n = half.size
            step = solve_triangular(factor[:n, :n], half - factor[:n, n:] @ moved)
            deltas.append(step / self._growth)
        return moved / self._growth, deltas
