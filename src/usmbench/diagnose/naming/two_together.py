"""Two causes, each weighed given the other."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from usmbench.diagnose.fitting.refining import refine_widely
from usmbench.diagnose.naming.ranking import TELLING, Ranked, nearest, rank
from usmbench.diagnose.naming.roughly_beside import roughly_together
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.effects.base import Effect

_RIVALS = 2  # of the first of two causes, since each takes time; nothing measured sets it
# It ends sooner where the first comes back or the deviance gains no more; the bound only keeps two
# from changing places for ever.
_TURNS = 4


@dataclass(frozen=True, slots=True)
class Pair:
    """Two causes with their rivals.

    Parameters
    ----------
    first, second
        Candidates for the one, best first, and for the other beside it.
    brings
        Deviance that the best two take away.
    """

    first: list[Ranked]
    second: list[Ranked]
    brings: float


def together(problem: Problem, effects: Sequence[Effect], spread: float, start: Pair) -> Pair:
    """Weigh each of two causes given the other, until both stand.

    A cause that looks a little like two others is the best alone, and is neither.

    Parameters
    ----------
    problem
        The problem, of a motor that shows the first.
    effects
        Causes to weigh, none of them sporadic.
    spread
        Standard deviation of the whitened noise beside the first, at least 1.
    start
        The cause that was named first, and what is best beside it.
    """
    pair = _best_start(problem, effects, spread, start)
    for _ in range(_TURNS):
        kept = pair.second[0]
        alone = refine_widely(problem, replace(kept.fit, effects=kept.fit.effects[-1:]))
        again = rank(problem, _others(effects, kept), spread, alone)
        if again[0].effect == pair.first[0].effect:
            return replace(pair, first=again)
        brings = alone.statistic + again[0].fit.statistic
        if brings < pair.brings + TELLING * spread**2:
            break
        pair = Pair(pair.second, again, brings)
    return pair


def _best_start(problem: Problem, effects: Sequence[Effect], spread: float, best: Pair) -> Pair:
    """Return the pair that brings most, of the first cause and its rivals.

    What explains about as much as the first may explain more with another beside it.
    """
    first, second = best.first, best.second
    for rival in nearest(first)[1 : 1 + _RIVALS]:
        alone = refine_widely(problem, rival.fit)
        least = best.brings + TELLING * spread**2
        if roughly_together(problem, alone, second).statistic <= least:
            continue
        beside = rank(problem, _others(effects, rival), spread, alone)
        brings = alone.statistic + beside[0].fit.statistic
        if brings > least:
            best = Pair([rival, *(r for r in first if r is not rival)], beside, brings)
    return best


def _others(effects: Sequence[Effect], one: Ranked) -> list[Effect]:
    return [e for e in effects if e.name != one.effect.name]
