"""Which causes to name: the library weighed against the whitened residual."""

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cache

from usmbench.diagnose.fitting.fit import NOTHING, Fit
from usmbench.diagnose.fitting.scanning import charged_closely, fit_effect
from usmbench.diagnose.naming.chance import scatters
from usmbench.diagnose.naming.library_fits import fit_library
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.effects.base import Effect

# The usual levels of a test.
SIGNIFICANT = 0.01  # of what is weighed further, and of single windows
CLEAR = 0.05  # family-wise, for a name
_SAME = 0.5  # deviance: two that differ by less change the simulation alike
TELLING = 9.2  # deviance between two causes that data can tell: 99 % of chi-squared with two
# What else the model misses decides between causes this near, and not the cause: a share of little
# evidence (with 0.1 a delay in a triangle came out as hysteresis alone, see
# benchmarks/next_experiment.py), of much evidence an amount and what a form of an effect is off by.
_SIMILAR = 0.15
_MISFIT, FORM_OFF = 50.0, 0.03
_MOST_ALTERNATIVES = 5  # a name with more of them tells nothing, unless it is beyond chance
NO_CHANCE = 1e-6  # family-wise, where chance is ruled out; nothing measured sets it
_ONE_WAY = 2.0 * math.log(2.0)  # a parameter with one sign is given half the room beforehand


@dataclass(frozen=True, slots=True)
class Ranked:
    """A fit and what it is worth.

    Parameters
    ----------
    effect
        The effect that was added last.
    fit
        The fit, all of its effects together.
    statistic
        Drop of the deviance that the last effect brings, over the noise's spread.
    p_value
        Family-wise probability of it, less the misfit, where nothing is wrong.
    score
        Statistic less the price of its parameters, and the misfit.
    misfit
        What of the statistic does not speak for the cause: of one by chance whose scatter is not
        there, and of one that what the model may be off by passes for.
    """

    effect: Effect
    fit: Fit
    statistic: float
    p_value: float
    score: float
    misfit: float = 0.0


def rank(
    problem: Problem, effects: Sequence[Effect], spread: float, given: Fit = NOTHING
) -> list[Ranked]:
    """Weigh every effect, the best first.

    Parameters
    ----------
    problem
        The problem.
    effects
        Testable effects that are not sporadic.
    spread
        Standard deviation of the whitened noise, at least 1.
    given
        Effects already named.
    """
    held = given.effects

    def chance(alone: Fit) -> float:
        return min(1.0, alone.p_value * len(effects))

    def clear(fit: Fit) -> bool:
        return chance(_alone(fit, fit.statistic / spread**2)) < CLEAR

    @cache  # several forms have the same lookalikes
    def brings(other: Effect) -> float:
        return fit_effect(problem, other, held).statistic / spread**2

    price = math.log(max(problem.n_rows, 2))
    found = []
    for fit in fit_library(problem, effects, clear, given):
        effect, statistic = fit.effects[-1].effect, max(fit.statistic, 0.0) / spread**2
        misfit = _misfit(problem, fit, statistic, brings)
        score = statistic - misfit - _price(_alone(fit, statistic), price)
        alone = _alone(fit, statistic - misfit)
        p_value = chance(alone)
        if NO_CHANCE < p_value < CLEAR:
            # Only where it may decide, since it takes many more shapes than the scan. Not of the
            # score, which must not fall where a statistic that rises comes into this range.
            alone = charged_closely(problem, alone, held)
            fit, p_value = replace(fit, roughness=alone.roughness), chance(alone)
        found.append(Ranked(effect, fit, statistic, p_value, score, misfit))
    return sorted(found, key=lambda r: -r.score)


def _misfit(
    problem: Problem, fit: Fit, statistic: float, brings: Callable[[Effect], float]
) -> float:
    """Return what of the statistic of a fit's last effect does not speak for it."""
    effect = fit.effects[-1].effect
    if effect.by_chance and not scatters(problem, fit.effects):
        # Whatever explains about as much goes first, and chance, too.
        return max(_MISFIT, telling_deviance(statistic))
    return statistic if _passes_for_it(effect, statistic, brings) else 0.0


def _alone(fit: Fit, statistic: float) -> Fit:
    """Return the last effect of a fit with what it brings."""
    return Fit(fit.effects[-1:], statistic, fit.roughness)


def _passes_for_it(effect: Effect, statistic: float, brings: Callable[[Effect], float]) -> bool:
    """Whether what a model may be off by explains about as much as a cause that looks like it."""
    if statistic < TELLING:
        return False
    least = statistic - telling_deviance(statistic)
    return any(brings(other) > least for other in effect.lookalikes)


def _price(alone: Fit, each: float) -> float:
    """Price of an effect's parameters in deviance: of those scanned no less than of the scan.

    One of many grids of phases fits anything better than one more parameter does.
    """
    parameters = alone.effects[0].effect.parameters
    n_scanned = sum(p.scanned for p in parameters)
    n_sized, one_way = len(parameters) - n_scanned, sum(p.one_way for p in parameters)
    scanned = max(n_scanned * each, alone.searched)
    return max(n_sized * each + scanned, each) - one_way * _ONE_WAY


def telling_deviance(evidence: float) -> float:
    """Return the deviance that tells two causes apart.

    Parameters
    ----------
    evidence
        What the better of the two brings.
    """
    return max(TELLING, min(_SIMILAR * evidence, _MISFIT + FORM_OFF * evidence))


def alternatives(ranked: Sequence[Ranked]) -> tuple[str, ...]:
    """Return the other causes that explain about as much as the best.

    What explains no more than chance lets the best of a whole library is none of them.

    Parameters
    ----------
    ranked
        The candidates, best first.
    """
    best = ranked[0]
    near = telling_deviance(best.statistic)
    rivals = [r for r in ranked[1:] if r.p_value < 1.0]
    names = [r.effect.name for r in rivals if best.score - r.score < near]
    return tuple(dict.fromkeys(n for n in names if n != best.effect.name))


def undecided(ranked: Sequence[Ranked]) -> bool:
    """Return whether so many causes explain about as much that to name one tells nothing.

    Where chance is ruled out, even a long list says what it is not.

    Parameters
    ----------
    ranked
        The candidates, best first.
    """
    return len(alternatives(ranked)) > _MOST_ALTERNATIVES and ranked[0].p_value > NO_CHANCE


def best_forms(ranked: Sequence[Ranked], taken: Collection[str] = ()) -> list[Ranked]:
    """Return the best form of each cause, the best first.

    Parameters
    ----------
    ranked
        The candidates, best first.
    taken
        Causes to leave out.
    """
    forms: dict[str, Ranked] = {}
    for r in ranked:
        if r.effect.name not in taken:
            forms.setdefault(r.effect.name, r)
    return list(forms.values())


def nearest(ranked: Sequence[Ranked]) -> list[Ranked]:
    """Return the best form of the best cause, and of each that explains about as much.

    Parameters
    ----------
    ranked
        The candidates, best first.
    """
    names = (ranked[0].effect.name, *alternatives(ranked))
    return [next(r for r in ranked if r.effect.name == name) for name in names]


def same_shape(ranked: Sequence[Ranked]) -> set[str]:
    """Return the best cause and those that change the simulation just as it does.

    Parameters
    ----------
    ranked
        The candidates, best first.
    """
    best = ranked[0]
    return {r.effect.name for r in ranked if abs(r.statistic - best.statistic) < _SAME}


def begun_with(ranked: Sequence[Ranked], effect: Effect) -> list[Ranked] | None:
    """Return the ranking begun with an effect that is the best, or as good; None where it is not.

    Parameters
    ----------
    ranked
        The candidates, best first.
    effect
        One of them.
    """
    own = next(r for r in ranked if r.effect == effect)
    if own.effect.name != ranked[0].effect.name or own.score < ranked[0].score - _SAME:
        return None
    return [own, *(r for r in ranked if r is not own)]
