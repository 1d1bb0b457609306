"""Two causes of which neither is found alone, nor before the other.

A register that drops bits sets every phase too low by half a step on average; where somebody has
set that right by an offset, either alone would make the simulation worse. And where another offset
adds to it, the two together pass for one, and what the steps leave for a noise that has grown. An
offset and teeth that lean against it hold, alone, on no block that a fit has not seen; where the
teeth lean with it, a weight is nearly the same as the two.
"""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from usmbench.diagnose.fitting.fit import NOTHING, Fit
from usmbench.diagnose.fitting.foretold import held_out_drop
from usmbench.diagnose.fitting.refining import refine, refine_widely
from usmbench.diagnose.fitting.scanning import fit_effect, sharpen
from usmbench.diagnose.naming.ranking import (
    CLEAR,
    SIGNIFICANT,
    Ranked,
    alternatives,
    begun_with,
    best_forms,
    rank,
)
from usmbench.diagnose.naming.roughly_beside import roughly_together
from usmbench.diagnose.naming.stepwise import Named, settled
from usmbench.diagnose.naming.verdict import by_share_left
from usmbench.diagnose.naming.worth import SECOND_LEAST, First, earns_its_place, worth_a_name
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.views import omnibus
from usmbench.diagnose.residual.whole import doubted_test, whole_test
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect

# Rivals of the best cause, and smooth ones beside a jagged one, since each takes time; nothing
# measured sets either.
_RIVALS, _SMOOTH = 2, 3


def hidden_pair(
    problem: Problem,
    ranked: Sequence[Ranked],
    effects: Sequence[Effect],
    spread: float,
    named: Named | None = None,
) -> Named | None:
    """Name two causes at once, or return None.

    These are a jagged and a smooth one, or the best one and what is best beside it, or a rival and
    what roughly is.

    Parameters
    ----------
    problem
        The problem.
    ranked
        Every cause alone, best first.
    effects
        Causes to weigh, none of them sporadic.
    spread
        Standard deviation of the whitened noise where nothing is named.
    named
        One cause that is named alone, and that neither of the two may be; None for none.
    """
    taken = set() if named is None else {a.effect.name for a in named.fit.effects}
    free = [e for e in effects if e.name not in taken]
    if len({e.name for e in free}) < 2:
        return None
    pairs = [_led_by(problem, best_forms(ranked, taken)[0], free, spread)]
    if named is None:
        pairs += [_fitted(problem, *pair) for pair in _jagged_and_smooth(ranked)]
        pairs += _led_by_rivals(problem, ranked)
    best = max(pairs, key=lambda fit: fit.statistic)
    one_alone = ranked if named is None else named.rankings[0]
    if not _explains(problem, best, spread):  # the cheapest to see comes first
        return None
    if not _worth_their_names(problem, best, one_alone, spread):
        return None
    return _settled(problem, best, effects, spread)


def smooth_pair(
    problem: Problem,
    ranked: Sequence[Ranked],
    effects: Sequence[Effect],
    spread: float,
    jagged: Fit,
) -> Named | None:
    """Name two causes instead of what was fitted to where each phase falls, or return None.

    A register has its grid exactly: one beside which others explain plainly more fits by accident.

    Parameters
    ----------
    problem, ranked, effects, spread
        As in `hidden_pair`.
    jagged
        What is named with a grid among it.
    """
    smooth, free = [r for r in ranked if not r.effect.jagged], [e for e in effects if not e.jagged]
    if len({e.name for e in free}) < 2:
        return None
    pairs = [_led_by(problem, smooth[0], free, spread), *_led_by_rivals(problem, smooth)]
    best = max(pairs, key=lambda fit: fit.statistic)
    if best.statistic - jagged.statistic < SECOND_LEAST * spread**2:
        return None
    if not (_explains(problem, best, spread) and _holds(problem, best, jagged, spread)):
        return None
    return _settled(problem, best, free, spread)


def _settled(problem: Problem, pair: Fit, effects: Sequence[Effect], spread: float) -> Named | None:
    """Weigh each of two causes beside the other, and return both if each is clear and first."""
    rankings = []
    for wanted, other in zip(pair.effects, reversed(pair.effects), strict=True):
        ranking = begun_with(_beside(problem, effects, spread, other), wanted.effect)
        if ranking is None or ranking[0].p_value >= CLEAR:
            return None
        rankings.append(ranking)
    return settled(problem, rankings, pair)


def _worth_their_names(
    problem: Problem, pair: Fit, one_alone: Sequence[Ranked], spread: float
) -> bool:
    """Whether two causes hold on unseen blocks, and explain more than the form of one is off by."""
    alone = refine(problem, one_alone[0].fit)
    if not _holds(problem, pair, alone, spread):
        return False
    first = First(alone.statistic / spread**2, frozenset(alternatives(one_alone)))
    return earns_its_place(problem, alone.effects, pair.effects, first, spread)


def _holds(problem: Problem, pair: Fit, other: Fit, spread: float) -> bool:
    """Whether two causes are worth their names on unseen blocks, and better there than others."""
    unseen = held_out_drop(problem, pair)
    if not worth_a_name(problem, NOTHING, pair, unseen, First(), spread):
        return False
    return bool(np.sum(unseen) > np.sum(held_out_drop(problem, other)))


def _explains(problem: Problem, pair: Fit, spread: float) -> bool:
    """Whether two causes leave nothing but what their form may be off by."""
    before = whole_test(problem, omnibus(problem), (), spread)
    after = doubted_test(problem, pair.effects, spread)
    return by_share_left(before, after, pair.statistic / spread**2) == "explained"


def _led_by(problem: Problem, lead: Ranked, effects: Sequence[Effect], spread: float) -> Fit:
    """Fit a cause and what is best beside it, together."""
    first = refine(problem, lead.fit)
    others = [e for e in effects if e.name != lead.effect.name]
    return refine_widely(problem, rank(problem, others, spread, first)[0].fit)


def _led_by_rivals(problem: Problem, ranked: Sequence[Ranked]) -> list[Fit]:
    """Fit the best rivals of the best cause, each with what roughly is best beside it."""
    rivals = best_forms(ranked)[1 : 1 + _RIVALS]
    rough = [roughly_together(problem, refine(problem, r.fit), ranked) for r in rivals]
    return [pair for pair in rough if len(pair.effects) > 1]


def _jagged_and_smooth(ranked: Sequence[Ranked]) -> Iterator[tuple[Effect, Effect]]:
    """Yield the forms of a clear jagged cause with each smooth one that may hide it.

    That acts at the same place, or is among the best alone: it makes up for the half step by which
    one form differs from another, of which the right one may then show nothing alone.
    """
    jagged = [r for r in ranked if r.effect.jagged]
    clear = {r.effect.name for r in jagged if r.p_value < SIGNIFICANT}
    smooth = [r for r in ranked if _has_only_sizes(r.effect)]
    best = {r.effect for r in best_forms(smooth)[:_SMOOTH]}
    for one, other in product(jagged, smooth):
        alike = other.effect.stage == one.effect.stage or other.effect in best
        if one.effect.name in clear and alike:
            yield one.effect, other.effect


def _has_only_sizes(effect: Effect) -> bool:
    return bool(effect.parameters) and not any(p.scanned for p in effect.parameters)


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
