"""Rivals of each of two causes weighed once more, in the motor that shows both.

A cause is weighed beside what is named before it, in a motor that differs from run to run as one
without it. Of a motor that is slower by a sixth that is far off.
"""

from dataclasses import replace

from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.naming.chance import chancy_of
from usmbench.diagnose.naming.ranking import Ranked
from usmbench.diagnose.naming.roughly_beside import roughly_beside
from usmbench.diagnose.naming.stepwise import Named
from usmbench.diagnose.residual.problem import Problem

# Of what the name brings: less is no rival. How many, since each takes time. Nothing measured
# sets either.
_HALF, _RIVALS = 0.5, 4


def weighed_again(named: Named) -> Named:
    """Return two causes with their rivals in order, and the best of these in their place.

    Parameters
    ----------
    named
        What is named; a single cause is returned as it is, and so is what stands beside one by
        chance, whose scatter covers what tells it from others: it was weighed where that is not.
    """
    if len(named.rankings) < 2 or chancy_of(named.fit.effects):
        return named
    rankings, fit = [], named.fit
    for ranking in named.rankings:
        found, no_rivals = _ranked_again(named, fit, ranking)
        again = sorted(found, key=lambda r: -r.score)
        fit = again[0].fit
        left_out = {r.effect.name for r in again} | no_rivals
        rankings.append([*again, *(r for r in ranking[1:] if r.effect.name not in left_out)])
    return replace(named, rankings=rankings, fit=fit)


def _ranked_again(named: Named, fit: Fit, ranking: list[Ranked]) -> tuple[list[Ranked], set[str]]:
    """Return a cause and its rivals, fitted anew beside the other names, and what is no rival.

    One that was ahead of it takes no place: it did not hold on rows that its fit had not seen. Nor
    does one with which the others fit better, and without it as well.
    """
    problem, best = named.problem, ranking[0]
    (own,) = (a for a in fit.effects if a.effect.name == best.effect.name)
    rest = tuple(a for a in fit.effects if a is not own)
    names = {a.effect.name for a in fit.effects}
    others = [r for r in ranking if r.effect.name not in names and r.score <= best.score]
    least = _HALF * (fit.statistic - problem.drop(rest))
    near = [(r, beside) for r, beside in roughly_beside(problem, others, rest) if beside > least]
    rivals: dict[str, Ranked] = {}
    for rival, _ in sorted(near, key=lambda pair: -pair[1]):
        rivals.setdefault(rival.effect.name, rival)
    again = [replace(best, fit=replace(fit, effects=(*rest, own)))]
    for rival in list(rivals.values())[:_RIVALS]:
        effects = (*rest, rival.fit.effects[-1])
        other = refine(problem, Fit(effects, problem.drop(effects), fit.roughness))
        other = _in_its_own_motor(problem, other)
        without = other.effects[:-1]
        alone = refine(problem, Fit(without, problem.drop(without), fit.roughness))
        alone = _in_its_own_motor(problem, alone)
        if other.statistic - alone.statistic > least:
            more = (other.statistic - fit.statistic) / named.spread**2
            again.append(_by(other, rival, best.statistic + more, len(ranking)))
    unweighed = {r.effect.name for r in others if r.misfit != 0.0}
    held = {*(r.effect.name for r in again), *list(rivals)[_RIVALS:], *unweighed}
    return again, {r.effect.name for r in others} - held


def _in_its_own_motor(problem: Problem, fit: Fit) -> Fit:
    """Return a fit refined in the motor that it describes, and what it leaves less there.

    By a motor that shows others a gain that wanders, far beyond chance, would do what they do.
    """
    shown = problem.showing(fit.effects)
    again = refine(shown, replace(fit, statistic=shown.drop(fit.effects)))
    return replace(again, statistic=problem.deviance - shown.deviance + again.statistic)


def _by(fit: Fit, ranked: Ranked, brings: float, n_forms: int) -> Ranked:
    """Return a cause with another fit, and what that makes of its evidence among so many forms."""
    price = ranked.statistic - ranked.score
    chance = Fit(fit.effects[-1:], brings - ranked.misfit, ranked.fit.roughness).p_value
    p_value = min(1.0, n_forms * chance)
    return replace(ranked, fit=fit, statistic=brings, score=brings - price, p_value=p_value)
