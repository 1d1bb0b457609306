"""Degree, knots and smoothness of a curve, chosen by what they predict on data held out.

Every candidate is one least-squares problem over the same rows. The rows of each fold are reduced
to a triangular factor once; fitting on all folds but one and testing on that one then costs next
to nothing, and no normal equations are formed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.curve_rows import FOLDS, CurveRows
from usmbench.identify.design import stacked_basis
from usmbench.identify.knots import place_knots
from usmbench.identify.prior_rows import prior_rows
from usmbench.identify.triangle import triangle
from usmbench.model.hammerstein import StaticCurve

Array = NDArray[np.float64]

DEGREES = (1, 2, 4, 8, 12, 18, 24, 30, 48, 64)
STIFFNESSES = (1e-5, 1e-4, 1e-3, 1e-2)
_SHARES = (0.4, 0.7, 0.9)
_WIDTHS = (0.005, 0.01, 0.025, 0.06)  # of the range of phases
_GATHERING_DEGREE, _BEST = 24, 3  # how knots are gathered is compared at one degree first
_HIGH_DEGREE = 30  # beyond it only as long as a higher one is better
_MEANS, _CLOSEST = 3.0, 1.1  # standard errors of a mean, least misfits: a curve that meets them
_SIMPLER = 1.02  # a candidate must beat a simpler one by this factor


@dataclass(frozen=True, slots=True)
class Choice:
    """A curve's shape parameters.

    Parameters
    ----------
    knots_deg
        The knots.
    stiffness
        Strength of the pull on the second differences of δ; see `prior_rows`.
    held_out_rad_s
        Root mean square error on the held-out samples.
    misfit_rad_s
        Root mean square error at the phases that it was fitted to, beyond what samples scatter.
    held
        Whether it stays between few levels, where it should.
    """

    knots_deg: Array
    stiffness: float
    held_out_rad_s: float
    misfit_rad_s: float
    held: bool = True


@dataclass(frozen=True, slots=True)
class _Gathering:
    """How knots gather: around which phases, how many of them, how closely (of the range)."""

    at_deg: tuple[float, ...] = ()
    share: float = 0.0
    width: float = 1.0

    def knots_deg(self, span_deg: tuple[float, float], degree: int) -> Array:
        """Return the knots of a degree."""
        low_deg, high_deg = span_deg
        width_deg = self.width * (high_deg - low_deg)
        return place_knots(low_deg, high_deg, degree, self.at_deg, self.share, width_deg)


_EVEN = _Gathering()


def choose_curve(
    rows: CurveRows,
    degrees: Sequence[int],
    bends_deg: Sequence[tuple[float, ...]],
    span_deg: tuple[float, float],
    widths: Sequence[float] = _WIDTHS,
    stiffnesses: Sequence[float] = STIFFNESSES,
) -> Choice:
    """Return the candidate that predicts held-out samples best, the simplest among equals.

    Parameters
    ----------
    rows
        The samples.
    degrees
        Degrees to compare.
    bends_deg
        Sets of phases at which the curve may bend sharply: those to gather knots at.
    span_deg
        Ends of the curve.
    widths
        How closely knots may be gathered, of the range of phases.
    stiffnesses
        Strengths to compare.
    """
    middle = min(degrees, key=lambda degree: abs(degree - _GATHERING_DEGREE))
    ways = [_Gathering(*way) for way in product(bends_deg, _SHARES, widths)]
    tries = [judge_knots(rows, way.knots_deg(span_deg, middle), stiffnesses) for way in ways]
    judged = [choice.held_out_rad_s for choice in tries]
    kept = [_EVEN, *(ways[k] for k in np.argsort(judged, kind="stable")[:_BEST])]
    tried: list[Choice] = []
    for degree in degrees:
        before = _best(rows, tried) if tried else None
        for way in kept:
            tried += _judged(rows, way.knots_deg(span_deg, degree), stiffnesses)
        if degree > _HIGH_DEGREE and _best(rows, tried) is before:
            break
    return _best(rows, tried)


def _best(rows: CurveRows, tried: Sequence[Choice]) -> Choice:
    """Return the choice that predicts best, the first among equals.

    Where few phases are held, the next one is no guide to another: a curve has to meet those that
    it was fitted to first.
    """
    met = _MEANS * rows.mean_error_rad_s, _CLOSEST * min(choice.misfit_rad_s for choice in tried)
    meeting = [choice for choice in tried if choice.misfit_rad_s <= max(met)]
    able = [choice for choice in meeting if choice.held] or meeting
    best = able[0]
    for choice in able:
        if better(choice, best):
            best = choice
    return best


def better(choice: Choice, simpler: Choice) -> bool:
    """Return whether a choice predicts so much better that it is worth being less simple.

    Parameters
    ----------
    choice, simpler
        The two, judged on the same samples.
    """
    return _SIMPLER * choice.held_out_rad_s < simpler.held_out_rad_s


def judge_knots(
    rows: CurveRows, knots_deg: Array, stiffnesses: Sequence[float] = STIFFNESSES
) -> Choice:
    """Return the best stiffness for given knots.

    Parameters
    ----------
    rows
        The samples.
    knots_deg
        The knots.
    stiffnesses
        Strengths to compare.
    """
    return min(_judged(rows, knots_deg, stiffnesses), key=lambda choice: choice.held_out_rad_s)


def fitted_curve(rows: CurveRows, choice: Choice) -> StaticCurve:
    """Return the curve of a choice, fitted to all of its samples.

    Parameters
    ----------
    rows
        The samples.
    choice
        Knots and stiffness.
    """
    factors, fixed = _fold_factors(rows, choice.knots_deg)
    n = sum(int(np.count_nonzero(f >= 0)) for f in rows.fold)
    pull = prior_rows(choice.knots_deg, choice.stiffness, rows.standing_deg, n, rows.levels)
    (delta,) = _solved([triangle(fixed, *factors)], [pull])
    return StaticCurve(choice.knots_deg, delta[0])


def _judged(rows: CurveRows, knots_deg: Array, stiffnesses: Sequence[float]) -> list[Choice]:
    """Cross-validate one set of knots at several stiffnesses."""
    factors, fixed = _fold_factors(rows, knots_deg)
    n = sum(int(np.count_nonzero(f >= 0)) for f in rows.fold)
    trained = [triangle(fixed, *factors[:k], *factors[k + 1 :]) for k in range(FOLDS)]
    every, n_used = triangle(fixed, *factors), sum(np.count_nonzero(f >= -1) for f in rows.fold)
    pulls = [prior_rows(knots_deg, s, rows.standing_deg, n, rows.levels) for s in stiffnesses]
    choices = []
    for stiffness, deltas in zip(stiffnesses, _solved([*trained, every], pulls), strict=True):
        unseen = sum(map(_square, factors, deltas[:-1]))
        own = _square(every, deltas[-1]) / max(n_used, 1)
        misfit_rad_s = float(np.sqrt(max(own - rows.scatter_rad_s**2, 0.0)))
        held_out_rad_s = float(np.sqrt(unseen / max(n, 1)))
        held = rows.levels is None or rows.levels.holds(StaticCurve(knots_deg, deltas[-1]))
        choices.append(Choice(knots_deg, stiffness, held_out_rad_s, misfit_rad_s, held))
    return choices


def _square(factor: Array, delta: Array) -> float:
    """Square of what a curve leaves of the rows of a factor."""
    left = factor[:, -1] - factor[:, :-1] @ delta
    return float(left @ left)


def _solved(factors: Sequence[Array], pulls: Sequence[Array]) -> Array:
    """Least squares from triangular factors whose last column is the outcome, pulled each way.

    Shape (pulls, factors, d + 1).
    """
    n = pulls[0].shape[1]
    stacked = np.zeros((len(pulls), len(factors), n + 1 + pulls[0].shape[0], n + 1))
    for k, pull in enumerate(pulls):
        stacked[k, :, n + 1 :, :n] = pull
    for k, factor in enumerate(factors):
        stacked[:, k, : factor.shape[0]] = factor
    reduced = np.asarray(np.linalg.qr(stacked, mode="r"), dtype=np.float64)
    corners, outcomes = reduced[..., :n, :n], reduced[..., :n, n]
    if np.all(np.diagonal(corners, axis1=-2, axis2=-1)):
        return np.asarray(np.linalg.solve(corners, outcomes[..., None])[..., 0], dtype=np.float64)
    return np.asarray((np.linalg.pinv(corners) @ outcomes[..., None])[..., 0], dtype=np.float64)


def _fold_factors(rows: CurveRows, knots_deg: Array) -> tuple[list[Array], Array]:
    """Triangular factors of each fold's rows (regressors, outcome), and of those never held out."""
    fold = np.concatenate(rows.fold)
    basis = stacked_basis(rows.phase_deg, knots_deg)
    stacked = [
        np.column_stack([rows.dynamics.respond(own), speed_rad_s]) * weight[:, None]
        for own, speed_rad_s, weight in zip(basis, rows.speed_rad_s, rows.weight, strict=True)
    ]
    matrix = np.vstack(stacked)
    parts = [triangle(matrix[fold == k]) for k in range(FOLDS)]
    return parts, triangle(matrix[fold == -1])
