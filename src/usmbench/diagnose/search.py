"""The search for causes: rank, settle the noise, add causes while they earn their place."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.fitting import Fit
from usmbench.diagnose.found import Found
from usmbench.diagnose.gain import held_out_drop
from usmbench.diagnose.knowledge import Knowledge
from usmbench.diagnose.naming import (
    CLEAR,
    SIGNIFICANT,
    Ranked,
    earns_its_place,
    rank,
    same_shape,
    whole_test,
)
from usmbench.diagnose.noise import Noise, estimate_noise
from usmbench.diagnose.problem import Basis, Problem
from usmbench.diagnose.refining import refine_widely
from usmbench.diagnose.spikes import isolated, spiked
from usmbench.diagnose.stretches import Mask, Stretch
from usmbench.diagnose.views import omnibus
from usmbench.model.effects.base import Effect
from usmbench.model.extended import Applied

Array = NDArray[np.float64]

_MOST_CAUSES = 3
_HUBER = 2.5
_FEWEST_ROWS = 8.0  # that a cause has to explain better


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
    masks = _without(stretches, spiked(stretches, residuals, noise, near_steps=False))
    problem = Problem(stretches, known, noise, masks, own)
    ranked = rank(problem, effects, 1.0)
    best: tuple[Applied, ...] = ()
    if ranked[0].p_value < SIGNIFICANT:
        best = refine_widely(problem, ranked[0].fit).effects
    left = problem.left_rad_s(best)
    if known.noise is None:
        noise = estimate_noise(stretches, left, masks)
    # What fits a few windows that stand alone makes others do so.
    fars = [spiked(stretches, r, noise, near_steps=True) for r in (problem.residual_rad_s, left)]
    masks = _without(stretches, min(fars, key=lambda far: sum(map(np.count_nonzero, far))))
    problem = problem.weighed(noise, masks)
    problem = problem.weighed(noise, masks, _weights(problem, left))
    basis = omnibus(problem)["all"]
    spread = _spread(problem, basis, best)
    ranked = rank(problem, effects, spread)
    named, fit, spread = _named(problem, basis, ranked, effects, spread)
    before = whole_test(problem, basis, (), spread)
    after = whole_test(problem, basis, fit.effects, spread)
    return Found(problem, spread, ranked, named, fit, before, after)


def _white(noise: Noise) -> Noise:
    """Take the colour from a noise that was estimated with the effect in it."""
    return replace(noise, ar=np.empty(0), innovation=1.0)


def _named(
    problem: Problem,
    basis: Basis,
    ranked: list[Ranked],
    effects: Sequence[Effect],
    spread: float,
) -> tuple[list[list[Ranked]], Fit, float]:
    """Add causes while each explains more of blocks that its fit has not seen."""
    named: list[list[Ranked]] = []
    fit, here, earned = Fit((), 0.0, 0.0), ranked, np.zeros(1)
    taken: set[str] = set()
    while here and len(named) < _MOST_CAUSES and here[0].p_value < CLEAR:
        if here[0].score <= 0.0:
            break
        if named and not earns_its_place(here[0], named[0][0]):
            break
        longer = refine_widely(problem, here[0].fit)
        drop = held_out_drop(problem, longer)
        more = drop - earned
        # One block alone may be an accident.
        if min(float(np.sum(more)), float(np.sum(more) - np.max(more))) <= 0.0:
            break
        if _rows_behind(problem, fit, longer) < _FEWEST_ROWS:
            break
        named.append(here)
        fit, earned = longer, drop
        spread = _spread(problem, basis, fit.effects)
        taken |= same_shape(here)
        here = rank(problem, [e for e in effects if e.name not in taken], spread, fit)
    return named, fit, spread


def _rows_behind(problem: Problem, fit: Fit, longer: Fit) -> float:
    """Effective number of the rows that more causes explain better: (Σd)²/Σd² of what they gain."""
    before, after = (problem.left(f.effects)[: problem.n_rows] ** 2 for f in (fit, longer))
    gained = np.maximum(before - after, 0.0)
    return float(np.sum(gained) ** 2 / max(float(np.sum(gained**2)), 1e-300))


def _without(stretches: Sequence[Stretch], far: Sequence[Mask]) -> list[Mask]:
    """Rows to judge without those that stand alone, unless these are too many to be exceptions."""
    alone = np.concatenate([f[s.use] for s, f in zip(stretches, far, strict=True)])
    speed_rad_s = np.concatenate([s.simulated_rad_s[s.use] for s in stretches])
    if not isolated(alone, speed_rad_s):
        return [s.use for s in stretches]
    return [s.use & ~f for s, f in zip(stretches, far, strict=True)]


def _weights(problem: Problem, left_rad_s: Sequence[Array]) -> list[Array]:
    """Weights of the rows (Huber): noise near the dead zone has heavy tails."""
    white = np.abs(problem.carried(left_rad_s)[: problem.n_rows])
    scale = max(1.4826 * float(np.median(white)), 1.0)
    kept = np.sqrt(np.minimum(1.0, _HUBER * scale / np.maximum(white, 1e-12)))
    weights, at = [], 0
    for valid in problem.valid:
        weight = np.ones(valid.size)
        n = int(np.count_nonzero(valid))
        weight[valid] = kept[at : at + n]
        weights.append(weight)
        at += n
    return weights


def _spread(problem: Problem, basis: Basis, effects: Sequence[Applied]) -> float:
    """Robust standard deviation of the whitened noise outside the views, at least 1."""
    left = problem.left(effects)
    rows = (left - basis.vectors @ (basis.vectors.T @ left))[: problem.n_rows]
    return max(1.0, 1.4826 * float(np.median(np.abs(rows))))
