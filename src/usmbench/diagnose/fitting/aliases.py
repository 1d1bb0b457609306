"""Other values of a jagged effect that do about the same: grids that few phases hardly tell apart.

Each is a peak of its own, which a scan, made to tell grids from what is smooth, may step over.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import maximum_filter1d

from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.fitting.shape_ratings import Rated, matched
from usmbench.diagnose.fitting.shape_search import ShapeSearch
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied

_PEAKS = 24  # nothing measured sets it


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
        peaks = _peaks(problem, applied, others, apart=True)
        values, drop = max(peaks, key=lambda rated: rated[1], default=(applied.values, -np.inf))
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
    (value,) = applied.values.values()
    peaks = _peaks(problem, applied, others, apart=False)
    if not peaks:
        return value, value
    least = problem.drop([*others, applied]) - problem.drop(others) - rise
    alike = [value, *(x for values, drop in peaks if drop > least for x in values.values())]
    return min(alike), max(alike)


def _peaks(
    problem: Problem, applied: Applied, others: tuple[Applied, ...], *, apart: bool
) -> list[Rated]:
    """Return the values like an effect's own that fit best, and the drops that they bring."""
    effect = applied.effect
    tried, told_apart = effect.alike(applied.values, [s.context for s in problem.stretches])
    if not tried.size:
        return []
    (parameter,), search = effect.parameters, ShapeSearch(problem, effect, others)
    shapes = [{parameter.name: float(x)} for x in tried]
    worth = np.array([matched(t.drop, t.square) for t in search.best(shapes, ())])
    summit = (worth >= maximum_filter1d(worth, 3)) & (told_apart > 0.0 if apart else True)
    highest = np.flatnonzero(summit)[np.argsort(-worth[summit])][:_PEAKS]
    near = [(shapes[k], float(worth[k])) for k in highest]
    return [
        search.exactly(search.zoomed(rated, parameter, tried, (), matched)[0], ()) for rated in near
    ]
