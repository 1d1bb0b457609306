"""The search for causes: rank them, settle the noise, name what earns its place."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.command_times import at_moments_of
from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.fitting.huber_weights import huber_weights
from usmbench.diagnose.fitting.refining import refine_widely
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.naming.chance import chancy_of
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.pairs import hidden_pair, smooth_pair
from usmbench.diagnose.naming.ranking import FORM_OFF, SIGNIFICANT, Ranked, rank
from usmbench.diagnose.naming.remainder import LOUD
from usmbench.diagnose.naming.stepwise import Named, name_causes, noise_spread, settled
from usmbench.diagnose.naming.verdict import verdict_on
from usmbench.diagnose.naming.weighed_again import weighed_again
from usmbench.diagnose.noise.noise_estimate import noise_as_stated
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.diagnose.noise.rotor_states import steady
from usmbench.diagnose.noise.spikes import are_exceptions, off_steps, spiked
from usmbench.diagnose.residual.basis import Basis
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.views import omnibus
from usmbench.diagnose.residual.whole import doubted_test, whole_test
from usmbench.diagnose.result import STANDS
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect

Array = NDArray[np.float64]

_MOSTLY = 0.9  # of what is unexplained
# Times the scatter, which 5000 rows tell to that; two that pass for one leave more.
_AS_QUIET = 1.01


def search(
    stretches: Sequence[Stretch],
    known: Knowledge,
    own: Sequence[Applied],
    effects: Sequence[Effect],
) -> Found:
    """Look for the causes of what a model leaves.

    Parameters
    ----------
    stretches
        The runs.
    known
        What is known beforehand.
    own
        The model's own effects.
    effects
        Causes to weigh, none of them sporadic.
    """
    problem, left, best = _with_its_noise(stretches, known, own, effects)
    if best and any(np.any(s.moment_rad_s) for s in stretches):
        stretches = at_moments_of(stretches, problem.change_rad_s(best))
        problem, left, best = _with_its_noise(stretches, known, own, effects)
    weighed = _Weighed.of(problem, left, best, effects)
    named, found = weighed.one_by_one(effects)
    cleaner = _leaves_nothing(weighed, found, effects)
    if cleaner is not None:
        return cleaner
    unclear = _unclear(found)
    if unclear and _mostly_left_out(found):
        every = problem.with_masks([s.use for s in stretches])
        struck = _struck_by_chance(every, left, best, effects)
        if struck is not None:
            return struck
    if unclear:
        found = _with_a_pair(weighed, None, found, effects)
        return _without_a_trifle(weighed, found) if _unclear(found) else found
    if len(named.rankings) == 1 and named.leaves_a_cause:
        found = _with_a_pair(weighed, named, found, effects)
    return _without_a_grid(weighed, found, effects) if found.grid_leaves_more else found


def _with_its_noise(
    stretches: Sequence[Stretch],
    known: Knowledge,
    own: Sequence[Applied],
    effects: Sequence[Effect],
) -> tuple[Problem, list[Array], tuple[Applied, ...]]:
    """Settle the noise and the rows to judge; return also what the best cause leaves, and it."""
    residuals = [s.residual_rad_s for s in stretches]
    uses = [s.use for s in stretches]
    noise = known.noise or _white(noise_as_stated(stretches, residuals, uses, known.stated_rad_s))
    far = spiked(stretches, residuals, noise, near_steps=False)
    masks = _without(stretches, residuals, far)
    problem = Problem(stretches, known, noise, masks, own)
    ranked = rank(problem, effects, 1.0)
    best: tuple[Applied, ...] = ()
    if ranked[0].p_value < SIGNIFICANT:
        best = refine_widely(problem, ranked[0].fit).effects
    left = problem.left_rad_s(best)
    if known.noise is None:
        noise = noise_as_stated(stretches, left, masks, known.stated_rad_s)
    # What fits a few windows that stand alone makes others do so.
    tried = [
        (r, spiked(stretches, r, noise, near_steps=True)) for r in (problem.residual_rad_s, left)
    ]
    fewest = min(tried, key=lambda pair: sum(map(np.count_nonzero, pair[1])))
    masks = _without(stretches, fewest[0], off_steps(stretches, *fewest))
    return problem.weighed(noise, masks), left, best


@dataclass(frozen=True, slots=True)
class _Weighed:
    """Every cause alone, in a problem whose noise is settled."""

    problem: Problem
    basis: Basis
    spread: float
    ranked: list[Ranked]

    @classmethod
    def of(
        cls,
        problem: Problem,
        left: Sequence[Array],
        best: Sequence[Applied],
        effects: Sequence[Effect],
    ) -> "_Weighed":
        """Weigh them, less the rows that are far out where the best one is taken out."""
        problem = problem.weighed(problem.noise, problem.masks, huber_weights(problem, left))
        basis = omnibus(problem)
        spread = noise_spread(problem, basis, best)
        return cls(problem, basis, spread, rank(problem, effects, spread))

    def one_by_one(self, effects: Sequence[Effect]) -> tuple[Named, Found]:
        """Name causes while each earns its place, and return what they come to."""
        named = name_causes(self.problem, self.ranked, effects, self.spread)
        return named, self.found(named)

    def found(self, named: Named) -> Found:
        """Return what names come to."""
        before = whole_test(self.problem, self.basis, (), named.spread)
        if not named.fit.effects:
            return Found(self.problem, named.spread, self.ranked, [], named.fit, before, before)
        named = weighed_again(named)
        after = doubted_test(named.problem, named.fit.effects, named.spread)
        ranked, names = self.ranked, named.rankings
        return Found(named.problem, named.spread, ranked, names, named.fit, before, after)


def _leaves_nothing(weighed: _Weighed, found: Found, effects: Sequence[Effect]) -> Found | None:
    """Begin with what fits better and has a misfit, if it leaves nothing where the name does.

    A counter may lose the same share of each window, without the scatter that chance leaves.
    """
    if not found.named or not found.after.material:
        return None
    lead = found.named[0][0]
    for rival in weighed.ranked:
        if rival.misfit <= 0.0 or rival.statistic <= lead.statistic:
            continue
        ranked = [rival, *(r for r in weighed.ranked if r is not rival)]
        other = weighed.found(name_causes(weighed.problem, ranked, effects, weighed.spread))
        begins = other.names[:1] == (rival.effect.name,)
        if begins and not other.after.material and verdict_on(other, 0.0) == "explained":
            return other
    return None


def _struck_by_chance(
    problem: Problem, left: Sequence[Array], best: Sequence[Applied], effects: Sequence[Effect]
) -> Found | None:
    """Name causes with the windows that stand alone, if one of them strikes by chance, or none.

    A counter that loses counts in some windows may do so beside another cause.
    """
    _, found = _Weighed.of(problem, left, best, effects).one_by_one(effects)
    return found if chancy_of(found.fit.effects) and not _unclear(found) else None


def _with_a_pair(
    weighed: _Weighed, named: Named | None, found: Found, effects: Sequence[Effect]
) -> Found:
    """Name two causes at once instead, if they explain all."""
    pair = hidden_pair(weighed.problem, weighed.ranked, effects, weighed.spread, named)
    return _if_it_stands(weighed, pair, found)


def _without_a_grid(weighed: _Weighed, found: Found, effects: Sequence[Effect]) -> Found:
    """Name two causes at once instead of what is on a grid by accident."""
    problem, ranked = weighed.problem, weighed.ranked
    pair = smooth_pair(problem, ranked, effects, weighed.spread, found.fit)
    return _if_it_stands(weighed, pair, found)


def _if_it_stands(weighed: _Weighed, pair: Named | None, found: Found) -> Found:
    """Return what two causes come to, if they explain, or else what was found."""
    if pair is None:
        return found
    both = weighed.found(pair)
    quiet = both.spread <= _AS_QUIET * found.spread
    stands = quiet and verdict_on(both, 0.0) in STANDS
    return both if stands else found


def _without_a_trifle(weighed: _Weighed, found: Found) -> Found:
    """Leave out the lesser of two causes, if it brings no more than the other's form is off by.

    Two that leave something are patches; one that does may be the cause all the same.
    """
    whole = found.fit
    if len(whole.effects) != 2:
        return found
    each = (replace(whole, effects=(applied,)) for applied in whole.effects)
    fit = max((refine_widely(found.problem, one) for one in each), key=lambda f: f.statistic)
    if whole.statistic - fit.statistic > FORM_OFF * whole.statistic:
        return found
    lead = next(r for r in weighed.ranked if r.effect == fit.effects[0].effect)
    ranking = [lead, *(r for r in weighed.ranked if r is not lead)]
    alone = weighed.found(settled(weighed.problem, [ranking], fit))
    return found if _unclear(alone) else alone


def _mostly_left_out(found: Found) -> bool:
    """Whether most of what is unexplained is in windows that stand alone, and were left out."""
    problem, out = found.problem, 0.0
    for stretch, mask, left in zip(problem.stretches, problem.masks, found.left_rad_s, strict=True):
        far = (left / problem.noise.level_rad_s(stretch))[stretch.use & ~mask]
        out += float(far @ far) / found.spread**2
    judged = max(found.beyond_noise - found.explained, 0.0)
    return out > _MOSTLY * (out + judged)


def _unclear(found: Found) -> bool:
    """Whether something is wrong that the names do not explain."""
    return verdict_on(found, 0.0) == "unexplained" or found.spread > LOUD


def _white(noise: Noise) -> Noise:
    """Take the colour from a noise that was estimated with the effect in it."""
    return replace(noise, ar=np.empty(0), innovation=1.0)


def _without(
    stretches: Sequence[Stretch], residuals: Sequence[Array], far: Sequence[Mask]
) -> list[Mask]:
    """Rows to judge without those that stand alone, unless more than chance sets these apart."""
    if not are_exceptions(stretches, residuals, far, [steady(s) for s in stretches]):
        return [s.use for s in stretches]
    return [s.use & ~f for s, f in zip(stretches, far, strict=True)]
