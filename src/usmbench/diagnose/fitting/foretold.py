"""What effects foretell of blocks of the runs that their values were not fitted on."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask
from usmbench.diagnose.fitting.blocks import FOLDS, held_apart
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.residual.problem import Problem

Array = NDArray[np.float64]

GROSS, _HARDLY = 1.25, 0.1  # times a mean square: more than chance; of what is beyond it
_BY_CHANCE = 2.0  # standard deviations
_ROWS_A_VALUE = 10  # a fit of less says nothing of others; nothing measured sets it


def foretold_rad_s(problem: Problem, fit: Fit) -> list[Array]:
    """Return what effects change in each block, their values fitted on the others, by stretch.

    Parameters
    ----------
    problem
        The problem.
    fit
        The effects at their values on all rows; none foretells no change.

    Returns
    -------
    list of Array
        In rad/s, shape (N,) each.
    """
    foretold = [np.zeros(s.residual_rad_s.size) for s in problem.stretches]
    for _, rows, refit in _refits(problem, fit):
        changes = problem.change_rad_s(refit.effects)
        for own, unseen, change in zip(foretold, rows, changes, strict=True):
            own[unseen] = change[unseen]
    return foretold


def foretells_nothing(problem: Problem, foretold: Sequence[Array], *, sure: bool = False) -> bool:
    """Return whether effects foretell worse than none, or hardly touch what is plainly wrong.

    What fits the whitened residual may do neither where little weight lies on much of what is off.
    What the model is expected to leave is taken off first where these runs show it, since it may
    lie along a small change, or against it. Where they do not, the plain residual counts: a change
    may only make up for it.
    Nor is wrong what another day most likely moves: one gain moves all rows at once. What makes the
    simulation plainly worse is no correction of it, whatever else it fits, unless it is sure, and
    the day that hides it no rare one.

    Parameters
    ----------
    problem
        The problem.
    foretold
        As from `foretold_rad_s`.
    sure
        Whether they are one cause, and chance is ruled out for it.
    """
    left_rad_s = [r - c for r, c in zip(problem.residual_rad_s, foretold, strict=True)]
    plain, beyond, departed, change, level = (
        np.concatenate([p[mask] for p, mask in zip(part, problem.masks, strict=True)])
        for part in (
            [s.residual_rad_s for s in problem.stretches],
            problem.residual_rad_s,
            problem.departed_rad_s(left_rad_s),
            foretold,
            [problem.noise.level_rad_s(s) for s in problem.stretches],
        )
    )
    off_rad_s = np.concatenate(problem.unsure_rad_s(problem.masks))
    usual = float(departed @ departed) < _BY_CHANCE**2 * float(off_rad_s @ off_rad_s)
    worse = float(np.sum((plain - change) ** 2)) > GROSS * float(plain @ plain)
    if worse and not (sure and usual):
        return True
    no_news = float(level @ level + off_rad_s @ off_rad_s)
    residual = beyond if float(beyond @ beyond) < float(plain @ plain) else plain
    news = residual - departed
    above = float(news @ news)
    # The model's own error may lie along a change, and show it smaller or larger than it is.
    touched = _removed(_of_it(change, news) * change, news)
    if above > GROSS * no_news and touched < _HARDLY * (above - no_news):
        return True
    along = problem.unsure_along([c * m for c, m in zip(foretold, problem.masks, strict=True)])
    chance = 2.0 * float(np.hypot(np.linalg.norm(change * level), along))
    return _removed(change, residual) < -_BY_CHANCE * chance


def _removed(change_rad_s: Array, residual_rad_s: Array) -> float:
    """By how much a change lowers a residual's sum of squares."""
    return float(change_rad_s @ (2.0 * residual_rad_s - change_rad_s))


def _of_it(change_rad_s: Array, residual_rad_s: Array) -> float:
    """Share of a change, none to all, that lowers a residual's sum of squares most."""
    along = float(change_rad_s @ residual_rad_s) / max(float(change_rad_s @ change_rad_s), 1e-300)
    return float(np.clip(along, 0.0, 1.0))


def held_out_drop(problem: Problem, fit: Fit) -> Array:
    """Return by how much effects lower the deviance of blocks that their values never saw, by fold.

    Effects that are not there raise it, on average by the number of their parameters.

    Parameters
    ----------
    problem
        The problem.
    fit
        The effects at their values on all rows.
    """
    drop = np.zeros(FOLDS)
    for fold, rows, refit in _refits(problem, fit):
        unseen = problem.with_masks([m & r for m, r in zip(problem.masks, rows, strict=True)])
        drop[fold] = unseen.drop(refit.effects)
    return drop


def _refits(problem: Problem, fit: Fit) -> Iterator[tuple[int, Sequence[Mask], Fit]]:
    """Yield each fold, its rows, and the effects at their values on the rows of the others.

    Rows that the dynamics tie to the fold are left out of the fit, too. Where that leaves too few
    to say anything, nothing is foretold.
    """
    n_values = sum(len(a.effect.parameters) for a in fit.effects)
    for fold in range(FOLDS) if fit.effects else ():
        rows, left_out = zip(*(held_apart(s, fold) for s in problem.stretches), strict=True)
        masks = [mask & ~out for mask, out in zip(problem.masks, left_out, strict=True)]
        if sum(map(np.count_nonzero, masks)) >= _ROWS_A_VALUE * n_values:
            yield fold, rows, refine(problem.with_masks(masks), fit)
