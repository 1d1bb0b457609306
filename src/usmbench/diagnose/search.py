"""The search for causes: rank them, settle the noise, name what earns its place."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.basis import Basis
from usmbench.diagnose.found import Found, verdict_on
from usmbench.diagnose.knowledge import Knowledge
from usmbench.diagnose.naming import SIGNIFICANT, Ranked, doubted_test, rank, whole_test
from usmbench.diagnose.noise import Noise
from usmbench.diagnose.noise_estimate import estimate_noise
from usmbench.diagnose.pairs import hidden_pair
from usmbench.diagnose.problem import Problem
from usmbench.diagnose.refining import refine_widely
from usmbench.diagnose.remainder import LOUD
from usmbench.diagnose.robust import huber_weights
from usmbench.diagnose.spikes import are_exceptions, off_steps, spiked, steady
from usmbench.diagnose.stepwise import Named, name_causes, noise_spread
from usmbench.diagnose.stretches import Mask, Stretch
from usmbench.diagnose.views import omnibus
from usmbench.model.effects.base import Effect
from usmbench.model.extended import Applied

Array = NDArray[np.float64]


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
    residuals = [s.residual_rad_s for s in stretches]
    uses = [s.use for s in stretches]
    noise = known.noise or _white(estimate_noise(stretches, residuals, uses))
    far = spiked(stretches, residuals, noise, near_steps=False)
    masks = _without(stretches, residuals, far)
    problem = Problem(stretches, known, noise, masks, own)
    ranked = rank(problem, effects, 1.0)
    best: tuple[Applied, ...] = ()
    if ranked[0].p_value < SIGNIFICANT:
        best = refine_widely(problem, ranked[0].fit).effects
    left = problem.left_rad_s(best)
    if known.noise is None:
        noise = estimate_noise(stretches, left, masks)
    # What fits a few windows that stand alone makes others do so.
    tried = [
        (r, spiked(stretches, r, noise, near_steps=True)) for r in (problem.residual_rad_s, left)
    ]
    fewest = min(tried, key=lambda pair: sum(map(np.count_nonzero, pair[1])))
    masks = _without(stretches, fewest[0], off_steps(stretches, *fewest))
    problem = problem.weighed(noise, masks)
    problem = problem.weighed(noise, masks, huber_weights(problem, left))
    basis = omnibus(problem)["all"]
    spread = noise_spread(problem, basis, best)
    ranked = rank(problem, effects, spread)
    named = name_causes(problem, ranked, effects, spread)
    found = _found(problem, basis, ranked, named)
    unclear = verdict_on(found, None) == "unexplained" or found.spread > LOUD
    if not (unclear or (len(named.rankings) == 1 and named.leaves_a_cause)):
        return found
    pair = hidden_pair(problem, ranked, effects, spread, None if unclear else named)
    if pair is None:
        return found
    both = _found(problem, basis, ranked, pair)
    stands = verdict_on(both, None) == "explained" and both.spread <= found.spread
    return both if stands else found


def _found(problem: Problem, basis: Basis, ranked: list[Ranked], named: Named) -> Found:
    """Return what names come to."""
    effects, before = named.fit.effects, whole_test(problem, basis, (), named.spread)
    if not effects:
        return Found(problem, named.spread, ranked, [], named.fit, before, before)
    after = doubted_test(named.problem, effects, named.spread)
    return Found(named.problem, named.spread, ranked, named.rankings, named.fit, before, after)


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
