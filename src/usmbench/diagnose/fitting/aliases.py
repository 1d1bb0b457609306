"""Other values of a jagged effect that do about the same: grids that few phases hardly tell apart.

Each is a peak of its own, which a scan, made to tell grids from what is smooth, may step over.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

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
    for k, applied in enumerate(fit.effects):
        others = (*fit.effects[:k], *fit.effects[k + 1 :])
        values, drop = _best(problem, applied, others)
        if problem.drop(others) + drop > fit.statistic:
            better = replace(applied, values=values)
            effects = (*fit.effects[:k], better, *fit.effects[k + 1 :])
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
    tried, _ = applied.effect.alike(applied.values, [s.context for s in problem.stretches])
    drops = np.array([t.drop for t in _tried(problem, applied, others, tried)])
    least = problem.drop([*others, applied]) - problem.drop(others) - rise
    alike = np.append(tried[drops > least], list(applied.values.values()))
    return float(alike.min()), float(alike.max())


def _best(problem: Problem, applied: Applied, others: tuple[Applied, ...]) -> Rated:
    """Return the best value like an effect's own that nothing smooth does as well, and its drop."""
    effect, contexts = applied.effect, [s.context for s in problem.stretches]
    tried, told_apart = effect.alike(applied.values, contexts)
    if not tried.size:
        return dict(applied.values), -np.inf
    rated = [(t.values, matched(t.drop, t.square)) for t in _tried(problem, applied, others, tried)]
    worth = np.array([value for _, value in rated])
    summits = np.flatnonzero((worth >= maximum_filter1d(worth, 3)) & (told_apart > 0.0))
    highest = summits[np.argsort(-worth[summits])][:_PEAKS]
    (parameter,), search = effect.parameters, ShapeSearch(problem, effect, others)
    near = (search.zoomed(rated[k], parameter, tried, (), matched)[0] for k in highest)
    found = [search.exactly(values, ()) for values in near]
    return max(found, key=lambda one: one[1], default=(dict(applied.values), -np.inf))


def _tried(
    problem: Problem, applied: Applied, others: tuple[Applied, ...], values: Array
) -> Iterator[Tried]:
    """Yield what other values of an effect's only parameter come to."""
    (parameter,) = applied.effect.parameters
    shapes = [{parameter.name: float(x)} for x in values]
    return ShapeSearch(problem, applied.effect, others).best(shapes, ())
