"""What causes bring beside others, without a scan: each with the shape that it was found with."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine_widely
from usmbench.diagnose.fitting.scanning import fit_effect
from usmbench.diagnose.naming.ranking import Ranked
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied


def roughly_beside(
    problem: Problem, found: Sequence[Ranked], others: Sequence[Applied]
) -> Iterator[tuple[Ranked, float]]:
    """Yield each cause with what it brings beside others.

    Parameters
    ----------
    problem
        The problem.
    found
        Causes as they were found elsewhere; one that has a misfit there is left out.
    others
        Effects that are held.
    """
    without = problem.drop(others)
    for ranked in (r for r in found if r.misfit == 0.0):
        if any(p.scanned for p in ranked.effect.parameters):
            yield ranked, problem.drop((*others, ranked.fit.effects[-1])) - without
        else:
            fit = fit_effect(problem, ranked.effect, others)
            yield replace(ranked, fit=fit), fit.statistic


def roughly_together(problem: Problem, one: Fit, found: Sequence[Ranked]) -> Fit:
    """Return a cause with the best of some beside it, both refined; alone where there is none.

    Parameters
    ----------
    problem
        The problem.
    one
        The cause, as it fits alone.
    found
        The others, as they were found elsewhere; forms of the same cause are left out.
    """
    name = one.effects[-1].effect.name
    others = [r for r in found if r.effect.name != name]
    near = roughly_beside(problem, others, one.effects)
    best, _ = max(near, key=lambda pair: pair[1], default=(None, 0.0))
    if best is None:
        return one
    both = (*one.effects, best.fit.effects[-1])
    return refine_widely(problem, Fit(both, problem.drop(both), 0.0))
