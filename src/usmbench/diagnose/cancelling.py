"""Two causes at one place that nearly cancel: neither is found alone, nor before the other.

A register that drops bits sets every phase too low by half a step on average; where somebody has
set that right by an offset, either alone would make the simulation worse. And where another offset
adds to it, the two together pass for one, and what the steps leave for a noise that has grown.
"""

from collections.abc import Sequence
from itertools import product

from usmbench.diagnose.fitting import NOTHING, Fit
from usmbench.diagnose.gain import held_out_drop
from usmbench.diagnose.naming import CLEAR, Ranked, rank
from usmbench.diagnose.problem import Problem
from usmbench.diagnose.refining import refine_widely
from usmbench.diagnose.scanning import fit_effect, sharpen
from usmbench.diagnose.stepwise import Named, settled
from usmbench.diagnose.worth import First, worth_a_name
from usmbench.model.effects.base import Effect
from usmbench.model.extended import Applied


def cancelling(problem: Problem, effects: Sequence[Effect], spread: float) -> Named | None:
    """Name a jagged and a smooth cause that act at one place, or return None.

    Parameters
    ----------
    problem
        The problem.
    effects
        Causes to weigh, none of them sporadic.
    spread
        Standard deviation of the whitened noise where nothing is named.
    """
    pairs = [
        _fitted(problem, jagged, smooth)
        for jagged, smooth in product(effects, effects)
        if jagged.jagged and not smooth.jagged and smooth.stage == jagged.stage
    ]
    if not pairs:
        return None
    best = max(pairs, key=lambda fit: fit.statistic)
    if not worth_a_name(problem, NOTHING, best, held_out_drop(problem, best), First(), spread):
        return None
    jagged, smooth = best.effects
    rankings = [
        _beside(problem, effects, spread, smooth),
        _beside(problem, effects, spread, jagged),
    ]
    for (leader, *_), wanted in zip(rankings, best.effects, strict=True):
        if leader.effect != wanted.effect or leader.p_value >= CLEAR:
            return None
    return settled(problem, rankings, best)


def _fitted(problem: Problem, jagged: Effect, smooth: Effect) -> Fit:
    """Fit both: the jagged one where the smooth one's change may be anything, then together."""
    typical = Applied(smooth, {p.name: p.null + p.typical for p in smooth.parameters})
    free = problem.freeing([typical])
    found = sharpen(free, fit_effect(free, jagged)).effects
    return refine_widely(problem, fit_effect(problem, smooth, found))


def _beside(
    problem: Problem, effects: Sequence[Effect], spread: float, other: Applied
) -> list[Ranked]:
    """Weigh every cause but one beside that one."""
    alone = Fit((other,), problem.drop([other]), 0.0)
    return rank(problem, [e for e in effects if e.name != other.effect.name], spread, alone)
