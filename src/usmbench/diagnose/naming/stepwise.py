"""Stepwise naming: add causes while each earns its place, and weigh two of them together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from usmbench.diagnose.fitting.aliases import on_best_alias
from usmbench.diagnose.fitting.fit import NOTHING, Fit
from usmbench.diagnose.fitting.foretold import held_out_drop
from usmbench.diagnose.fitting.huber_weights import huber_weights, robust_spread
from usmbench.diagnose.fitting.refining import refine, refine_widely
from usmbench.diagnose.fitting.scanning import fit_effect, sharpen
from usmbench.diagnose.naming.chance import scatters, struck_by
from usmbench.diagnose.naming.ranking import (
    CLEAR,
    FORM_OFF,
    TELLING,
    Ranked,
    alternatives,
    best_forms,
    nearest,
    rank,
    same_shape,
    undecided,
)
from usmbench.diagnose.naming.two_together import Pair, together
from usmbench.diagnose.naming.worth import First, earns_its_place, worth_a_name
from usmbench.diagnose.residual.basis import Basis
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.views import omnibus
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect

_MOST_CAUSES = 3  # two are named at most: a third only shows that they are patches
# For what healthy runs show anyhow; see "nothing hidden" in benchmarks/naming_campaign.py.
_UNUSUAL = 1e-9
_LEAST_CLEAR = 0.1  # of the rows: what is left where chance cannot strike must tell something
_BESIDE_GRID = 3  # causes, since each takes time; nothing measured sets it
_BY_CHANCE = 3.8  # mean squares: 95 % of chi-squared with one


@dataclass(frozen=True, slots=True)
class Named:
    """Causes that earned their place.

    Parameters
    ----------
    problem
        The problem of a motor that shows them.
    rankings
        One a cause, each given the others that were there when it was last weighed.
    fit
        All of them together.
    spread
        Standard deviation of the whitened noise that they leave.
    leaves_a_cause
        Whether another one is clear beside them, though not worth a name.
    """

    problem: Problem
    rankings: list[list[Ranked]]
    fit: Fit
    spread: float
    leaves_a_cause: bool = False


def name_causes(
    problem: Problem, ranked: list[Ranked], effects: Sequence[Effect], spread: float
) -> Named:
    """Add causes while each explains more of blocks that its fit has not seen.

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
    """
    found, here = Named(problem, [], NOTHING, spread), _news(problem, ranked, spread)
    while here and len(found.rankings) < _MOST_CAUSES:
        if here[0].p_value >= CLEAR or undecided(here):
            break
        before = found.rankings
        if len(before) == 1:
            start = Pair(before[0], here, found.fit.statistic + here[0].fit.statistic)
            pair = together(found.problem, effects, found.spread, start)
            before, here = [pair.first], pair.second
        worth = _first_worth(found, before, here)
        if worth is None:
            return replace(found, leaves_a_cause=True)
        here, longer = worth
        if len(before) == _MOST_CAUSES - 1 and _trifle(found, longer):
            break
        found = settled(problem, [*before, here], longer)
        if here[0].effect.by_chance and scatters(problem, longer.effects):
            return _with_the_rest(problem, effects, found)
        taken = set().union(*map(same_shape, found.rankings))
        others = [e for e in effects if e.name not in taken]
        beside = rank(found.problem, others, found.spread, found.fit)
        here = _news(found.problem, beside, found.spread)
    return found


def _trifle(found: Named, longer: Fit) -> bool:
    """Return whether a further cause brings no more than the forms of the others are off by.

    Beside a grid it may be what another form of that leaves nothing of.
    """
    if any(applied.effect.jagged for applied in longer.effects):
        return False
    whole = float(np.sum(held_out_drop(found.problem, longer)))
    return whole - float(np.sum(held_out_drop(found.problem, found.fit))) < FORM_OFF * whole


def settled(problem: Problem, rankings: list[list[Ranked]], fit: Fit) -> Named:
    """Return what is named, fitted once more in the problem of a motor that shows it.

    A grid is looked for among all that do about the same: only now, for these bend into much else.

    Parameters
    ----------
    problem
        The problem.
    rankings
        One a cause.
    fit
        All of them together.
    """
    fit = on_best_alias(problem, fit)
    shown = problem.showing(fit.effects)
    again = refine(shown, fit)
    left = noise_spread(shown, omnibus(shown), again.effects)
    return Named(shown, rankings, again, left)


def _first_worth(
    found: Named, before: Sequence[list[Ranked]], ranked: list[Ranked]
) -> tuple[list[Ranked], Fit] | None:
    """Return the ranking begun with what is worth a name, and its fit.

    Of causes that explain about as much, one may not hold on rows that its fit has not seen. Those
    found may have been weighed anew before it.
    """
    problem, first = found.problem, First()
    earned = held_out_drop(problem, found.fit)
    if found.rankings:
        every = [alternatives(ranking) for ranking in (*found.rankings, *before)]
        first = First(found.fit.statistic / found.spread**2, frozenset().union(*every))
    near = nearest(ranked)
    # What moves phases fits the rows that it moves over an edge of a grid, and holds on no others.
    if any(applied.effect.jagged for applied in found.fit.effects):
        near += [r for r in best_forms(ranked)[:_BESIDE_GRID] if r not in near]
    for best in (r for r in near if r.p_value < CLEAR):
        longer = refine_widely(problem, best.fit)
        drop = held_out_drop(problem, longer)
        if worth_a_name(problem, found.fit, longer, drop - earned, first, found.spread):
            return [best, *(r for r in ranked if r is not best)], longer
    return None


def _news(problem: Problem, ranked: list[Ranked], spread: float) -> list[Ranked]:
    """Leave out what healthy runs show anyhow, unless it is far beyond what a day may do.

    Where that leads, another cause counts only if it brings something beside it: else it is the
    same, seen through another cause.
    """
    habits = problem.known.habit_names
    usual = [r for r in ranked if r.effect.name in habits and r.p_value >= _UNUSUAL]
    rest = [r for r in ranked if r not in usual]
    if not rest or ranked[0] not in usual:
        return rest
    beside = rank(problem, [r.effect for r in rest], spread, ranked[0].fit)
    own = {r.effect.name for r in beside if r.p_value < CLEAR}
    return [r for r in rest if r.effect.name in own]


def _with_the_rest(problem: Problem, effects: Sequence[Effect], found: Named) -> Named:
    """Look anew where the last cause, which acts by chance, does not.

    Where it does, its scatter covers everything else.
    """
    chance = found.fit.effects[-1]
    struck = struck_by(problem, [chance])
    masks = [m & ~s for m, s in zip(problem.masks, struck, strict=True)]
    clear = problem.turned([chance]).weighed(problem.noise, masks)
    if clear.n_rows < _LEAST_CLEAR * problem.n_rows:
        return found
    # The scatter hid what is far out.
    clear = clear.weighed(problem.noise, masks, huber_weights(clear, clear.residual_rad_s))
    others = [e for e in effects if e.name != chance.effect.name]
    spread = noise_spread(clear, omnibus(clear), ())
    rest = name_causes(clear, rank(clear, others, spread), others, spread)
    if not rest.rankings:
        return found
    fit = _beside(problem, chance, rest.fit.effects)
    alone = refine_widely(problem, found.fit)
    there = problem.with_masks([m & s for m, s in zip(problem.masks, struck, strict=True)])
    if fit.statistic <= alone.statistic or _worse(there, alone, fit):
        return found
    # What the first does there, below the noise of a window, may have passed for another cause.
    beside = problem.with_masks(masks)
    evidence = beside.drop(alone.effects) / spread**2
    first = First(evidence, frozenset(alternatives(found.rankings[-1])))
    if evidence > TELLING and not earns_its_place(
        beside, alone.effects, fit.effects, first, spread
    ):
        return found
    both = settled(problem, [found.rankings[-1], *rest.rankings], fit)
    return replace(both, spread=found.spread)


def _worse(there: Problem, alone: Fit, fit: Fit) -> bool:
    """Whether more causes meet the windows that chance strikes worse, as far as scatter shows it.

    What acts elsewhere has to do so there, too.
    """
    left, more = there.left(alone.effects), there.left(fit.effects)
    scatter = float(left @ left) / max(there.n_rows, 1)
    return float(more @ more - left @ left) > _BY_CHANCE * scatter


def _beside(problem: Problem, chance: Applied, rest: Sequence[Applied]) -> Fit:
    """Fit what acts by chance anew, beside other causes, unless it fits better as it is."""
    again = sharpen(problem, fit_effect(problem, chance.effect, rest), rest)
    both = [(one, *rest) for one in (again.effects[-1], chance)]
    fits = (refine_widely(problem, Fit(b, problem.drop(b), 0.0)) for b in both)
    return max(fits, key=lambda fit: fit.statistic)


def noise_spread(problem: Problem, basis: Basis, effects: Sequence[Applied]) -> float:
    """Return the robust standard deviation of the whitened noise outside the views, at least 1.

    Parameters
    ----------
    problem
        The problem.
    basis
        Directions in which a model may be wrong.
    effects
        Effects that are taken out first.
    """
    left = problem.left(effects)
    return robust_spread(problem, basis.rest(left))
