"""Fit one effect to the whitened residual: a scan of what shapes it, its sizes to first order."""

from collections.abc import Sequence
from dataclasses import replace

from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.shape_ratings import as_is
from usmbench.diagnose.fitting.shape_search import ShapeSearch
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.effects.parameter import Parameter


def fit_effect(problem: Problem, effect: Effect, given: Sequence[Applied] = ()) -> Fit:
    """Fit one effect, beside others that are held where they are.

    Parameters
    ----------
    problem
        The problem.
    effect
        The effect.
    given
        Effects that act already; the statistic counts from them.
    """
    search = ShapeSearch(problem, effect, tuple(given))
    scanned, sized = _apart(effect)
    if scanned:
        values, drop, roughness = search.scan(scanned, sized)
    else:
        (values, drop), roughness = search.exactly({}, sized), 0.0
    return Fit((*given, Applied(effect, values)), drop, roughness)


def charged_closely(problem: Problem, fit: Fit, given: Sequence[Applied] = ()) -> Fit:
    """Return a fit that is charged for all shapes between those of the grid, too.

    Parameters
    ----------
    problem
        The problem.
    fit
        What `fit_effect` found, or came of it. Of one whose shape is its size, that is jagged, or
        that more than two parameters shape, the charge stays as it is.
    given
        Effects that act already, as they were given to `fit_effect`.
    """
    effect = fit.effects[-1].effect
    scanned, sized = _apart(effect)
    if len(scanned) not in (1, 2) or not sized or effect.jagged:
        return fit
    search = ShapeSearch(problem, effect, tuple(given))
    roughness = search.roughness(scanned, sized, fit.statistic)
    return replace(fit, roughness=max(fit.roughness, roughness))


def sharpen(
    problem: Problem, fit: Fit, given: Sequence[Applied] = (), *, closely: bool = False
) -> Fit:
    """Try ever finer values of what was scanned, around those of the grid.

    Parameters
    ----------
    problem
        The problem.
    fit
        What `fit_effect` found.
    given
        Effects that act already, as they were given to `fit_effect`.
    closely
        Whether a jagged effect is tried densely first, which takes time.
    """
    last = fit.effects[-1]
    scanned, sized = _apart(last.effect)
    search = ShapeSearch(problem, last.effect, tuple(given))
    axes = search.axes(scanned)
    best = (dict(last.values), fit.statistic)
    if closely and last.effect.jagged:
        best = search.closely(best, scanned)
    for p, axis in zip(scanned, axes, strict=True):
        best = search.zoomed(best, p, axis, sized, as_is)
    return Fit((*given, Applied(last.effect, best[0])), best[1], fit.roughness)


def _apart(effect: Effect) -> tuple[list[Parameter], list[Parameter]]:
    """Return the parameters that shape an effect, and those that size it."""
    scanned = [p for p in effect.parameters if p.scanned]
    return scanned, [p for p in effect.parameters if not p.scanned]
