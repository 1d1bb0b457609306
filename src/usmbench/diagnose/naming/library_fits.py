"""Every effect of the library fitted to what is left, each beside those named already."""

from collections.abc import Callable, Sequence

from usmbench.diagnose.fitting.fit import NOTHING, Fit
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.fitting.scanning import fit_effect, sharpen
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect

# How many with a scan are refined, the best to first order, since it takes time. Nothing measured
# sets it or the next.
_REFINED = 8
# Of what the best brings to first order, and times the size that this comes to: what is tried of
# the others. Nothing measured sets them, either.
_MAY_WIN, _TIMES = 0.05, (3.0, 10.0)


def fit_library(
    problem: Problem,
    effects: Sequence[Effect],
    clear: Callable[[Fit], bool],
    given: Fit = NOTHING,
) -> list[Fit]:
    """Return the fit of every effect, each with what it brings beyond those given.

    Parameters
    ----------
    problem
        The problem.
    effects
        The effects.
    clear
        Whether a fit is beyond chance.
    given
        Effects already named.
    """
    held = given.effects
    fits = sorted((fit_effect(problem, e, held) for e in effects), key=lambda f: -f.statistic)
    least = _MAY_WIN * fits[0].statistic if fits else 0.0
    rest = [_larger(problem, f, held) if f.statistic > least else f for f in fits[_REFINED:]]
    fits = sorted([*fits[:_REFINED], *rest], key=lambda f: -f.statistic)
    for k, fit in enumerate(fits):
        # To first order a size may come out far too small: a drag bends where the rotor stops.
        if k < _REFINED or not any(p.scanned for p in fit.effects[-1].effect.parameters):
            # What is tried so near is not charged for: chance must have no part in it.
            better = refine(problem, sharpen(problem, fit, held, closely=k == 0 and clear(fit)))
            fits[k] = Fit(better.effects, better.statistic - given.statistic, fit.roughness)
    return fits


def _larger(problem: Problem, fit: Fit, held: Sequence[Applied]) -> Fit:
    """Return a fit with its last effect as large as explains most, where to first order it is less.

    What begins at once, such as friction that falls with the speed, shows little of that at first.
    """
    last = fit.effects[-1]
    sized = [p for p in last.effect.parameters if not p.scanned]
    if not sized:
        return fit
    before = problem.drop(held)
    for times in _TIMES:
        sizes = {p.name: p.null + times * (last.values[p.name] - p.null) for p in sized}
        kept = {p.name: min(max(sizes[p.name], p.low), p.high) for p in sized}
        effects = (*held, Applied(last.effect, {**last.values, **kept}))
        brings = problem.drop(effects) - before
        if brings > fit.statistic:
            fit = Fit(effects, brings, fit.roughness)
    return fit
