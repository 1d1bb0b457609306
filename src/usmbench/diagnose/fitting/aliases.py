"""Other values of a jagged effect that do about the same: grids that few phases hardly tell apart.

Each is a peak of its own, which a scan, made to tell grids from what is smooth, may step over.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from usmbench.diagnose.cutting.stretches import Mask
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.fitting.shape_ratings import Rated, matched
from usmbench.diagnose.fitting.shape_search import ShapeSearch
from usmbench.diagnose.fitting.weighed_shapes import Tried
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied

Array = NDArray[np.float64]

_PEAKS = 10  # nothing measured sets it


def on_best_alias(problem: Problem, fit: Fit) -> Fit:
    """Return a fit with each jagged effect at that value among all like its own that fits best.

    What passes for something smooth is not among these: it would fit other causes as well.

    Parameters
    ----------
    problem
        The problem.
    fit
        A refined fit.
    """
    for k in range(len(fit.effects)):
        applied, others = fit.effects[k], (*fit.effects[:k], *fit.effects[k + 1 :])
        best = _best(problem, applied, others)
        if best is not None and problem.drop(others) + best[1] > fit.statistic:
            effects = (*fit.effects[:k], replace(applied, values=best[0]), *fit.effects[k + 1 :])
            fit = refine(problem, Fit(effects, 0.0, fit.roughness))
    return fit


def alias_range(
    problem: Problem, applied: Applied, others: tuple[Applied, ...], rise: float
) -> tuple[float, float]:
    """Return the least and the largest value that fits about as well as an effect's own.

    Parameters
    ----------
    problem
        The problem.
    applied
        The effect, of one parameter.
    others
        Effects beside it, held where they are.
    rise
        Deviance by which a value may fit less well.
    """
    tried, _ = _alike(problem, applied)
    drops = [t.drop for t in _at(ShapeSearch(problem, applied.effect, others), applied, tried)]
    least = problem.drop([*others, applied]) - problem.drop(others) - rise
    as_good = np.append(tried[np.array(drops) > least], list(applied.values.values()))
    return float(as_good.min()), float(as_good.max())


def _best(problem: Problem, applied: Applied, others: tuple[Applied, ...]) -> Rated | None:
    """Return the best value like an effect's own that nothing smooth does as well, and its drop."""
    tried, told_apart = _alike(problem, applied)
    if not tried.size:
        return None
    search = ShapeSearch(problem, applied.effect, others)
    rated = [(t.values, matched(t.drop, t.square)) for t in _at(search, applied, tried)]
    worth = np.array([value for _, value in rated])
    # A peak is wider than one step here, so that the best few of all would be one peak.
    summits = np.flatnonzero((worth >= maximum_filter1d(worth, 3)) & told_apart)
    found = []
    for k in summits[np.argsort(-worth[summits])][:_PEAKS]:
        near, _ = search.zoomed(rated[k], applied.effect.parameters[0], tried, (), matched)
        found.append(search.exactly(near, ()))
    return max(found, key=lambda one: one[1], default=None)


def _alike(problem: Problem, applied: Applied) -> tuple[Array, Mask]:
    """Return what `Effect.alike` says of an effect in these runs."""
    return applied.effect.alike(applied.values, [s.context for s in problem.stretches])


def _at(search: ShapeSearch, applied: Applied, values: Array) -> Iterator[Tried]:
    """Yield what other values of an effect's only parameter come to."""
    name = applied.effect.parameters[0].name
    return search.best([{name: float(x)} for x in values], ())
