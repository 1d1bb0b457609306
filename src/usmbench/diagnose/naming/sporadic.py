"""Causes that strike single windows named: those that stand alone, and what sets them apart."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.stats import poisson

from usmbench.diagnose.cutting.stretches import Mask, came_from
from usmbench.diagnose.evidence import Estimate, NamedCause
from usmbench.diagnose.naming.chance import chancy_of, struck_by
from usmbench.diagnose.naming.ranking import SIGNIFICANT, TELLING
from usmbench.diagnose.noise.spikes import (
    PLAIN,
    apart,
    are_exceptions,
    moved_rad_s,
    off_steps,
    spiked,
    steady,
    whole_count_rad_s,
)
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.effects.base import PHYSICS
from usmbench.model.effects.lone_windows import LoneWindows, SporadicEffect, Weighed
from usmbench.model.effects.registry import library
from usmbench.model.extended import Applied

Array = NDArray[np.float64]

# Far out without a neighbour, at places that do not repeat each other: fewer may be knocks, or
# where a plan has a rotor start, time and again.
_FEWEST = 3
_TOLD = 2  # healthy runs have one now and then
_AS_USUAL = 2.0  # times the rate of the identified runs: their plans differ
# A counter is off by whole ones; where speeds are whole counts, rounding makes one of every window.
_OF_COUNT, _OF_WHOLE = 0.25, 1.5
# What an effect's form may be off by is no count, nor what it changes by beside the window.
_OF_EFFECT, _SOON, _BESIDE = 3.0 * PHYSICS, 3, 5  # share; windows around


@dataclass(frozen=True, slots=True)
class Sporadic:
    """The finding.

    Parameters
    ----------
    applied
        The effect for the extended model.
    named
        The cause for the result.
    deviance
        Square of the windows that it may have struck, over the noise's: where the motor moves, of
        those that stand alone, and are no further off than where it runs steadily.
    """

    applied: Applied
    named: NamedCause
    deviance: float


def find_sporadic(problem: Problem, effects: Sequence[Applied], spread: float) -> Sporadic | None:
    """Name a sporadic cause where enough windows stand alone.

    Parameters
    ----------
    problem
        The problem.
    effects
        The other causes. Where one of them strikes by chance, its scatter covers what stands alone.
    spread
        Standard deviation of the whitened noise: in one that has grown, no window stands alone.
    """
    left = problem.left_rad_s(effects)
    clear = _clear(problem, effects)
    alone = [a & c for a, c in zip(_alone(problem, left, effects, spread), clear, strict=True)]
    calm, far = _plain(problem, left, alone)
    calm = [rows & c for rows, c in zip(calm, clear, strict=True)]
    rows = np.concatenate(calm)
    off_rad_s = np.concatenate(list(left))[rows]
    # A counter's steps leave every window of a hold off by the same part of a count.
    windows = LoneWindows(
        np.concatenate([s.simulated_rad_s for s in problem.stretches])[rows],
        np.concatenate([np.mean(apart(r), axis=0) for r in left])[rows],
        np.concatenate(far)[rows],
        problem.stretches[0].context.window_s,
    )
    before = [came_from(s.settled_rad_s, s.step_rad_s, s.lag) for s in problem.stretches]
    places = np.unique(np.concatenate(before)[rows][windows.alone])
    p_value = _p_value(windows, problem.known.spikes_hz)
    if places.size < _FEWEST or p_value > SIGNIFICANT:
        return None
    if not are_exceptions(problem.stretches, left, far, calm):
        return None
    kinds = [effect for effect in library() if isinstance(effect, SporadicEffect)]
    weighed = [(effect, effect.weigh(windows)) for effect in kinds]
    weighed.sort(key=lambda pair: -pair[1].log_likelihood)
    (effect, best), *others = weighed
    near = [e.name for e, w in others if 2.0 * (best.log_likelihood - w.log_likelihood) < TELLING]
    deviance = _deviance(problem, left, alone, float(np.max(np.abs(off_rad_s[windows.alone]))))
    estimates = _estimates(effect, best)
    named = NamedCause(
        effect.name,
        effect.form,
        effect.meaning,
        effect.mend,
        tuple(near),
        estimates,
        p_value,
        gain=0.0,  # no simulation foresees which windows it strikes
    )
    applied = Applied(effect, {e.name: e.value for e in estimates})
    return Sporadic(applied, named, deviance)


def _deviance(
    problem: Problem, left: Sequence[Array], alone: Sequence[Mask], most_rad_s: float
) -> float:
    """Square of the windows that stand alone, no further off than that, over the noise's."""
    deviance = 0.0
    for stretch, residual, mask in zip(problem.stretches, left, alone, strict=True):
        struck = mask & (np.abs(residual) <= most_rad_s)
        deviance += float(np.sum((residual / problem.noise.level_rad_s(stretch))[struck] ** 2))
    return deviance


def left_unnamed(problem: Problem, effects: Sequence[Applied], spread: float) -> list[str]:
    """Say of each stretch how many windows are not judged for standing alone.

    Parameters
    ----------
    problem
        The problem.
    effects
        The causes that are named.
    spread
        Standard deviation of the whitened noise, at least 1.

    Returns
    -------
    list of str
        A warning for each stretch that has such windows, for no move of its motor.
    """
    found = []
    left = problem.left_rad_s(effects)
    not_judged = [
        (steady(s) | s.use & (np.abs(r) > moved_rad_s(s))) & ~mask
        for s, r, mask in zip(problem.stretches, left, problem.masks, strict=True)
    ]
    far = _beyond(problem, left, not_judged, spread)
    for stretch, rows, residual in zip(problem.stretches, far, left, strict=True):
        off_rad_s = np.abs(residual[rows])
        duration_s = stretch.context.n * stretch.context.window_s
        if off_rad_s.size >= max(_TOLD, _usual(problem.known.spikes_hz, duration_s)):
            found.append(
                f"{stretch.name}: windows that stand alone are not judged: "
                f"{off_rad_s.size}, off by up to {np.max(off_rad_s):.3g} rad/s; no cause is named "
                "for them"
            )
    return found


def _clear(problem: Problem, effects: Sequence[Applied]) -> list[Mask]:
    """Rows that no other cause strikes by chance."""
    chancy = chancy_of(effects)
    if not chancy:
        return [s.use for s in problem.stretches]
    struck = struck_by(problem, chancy)
    return [s.use & ~hit for s, hit in zip(problem.stretches, struck, strict=True)]


def _plain(
    problem: Problem, left: Sequence[Array], far: Sequence[Mask]
) -> tuple[list[Mask], list[Mask]]:
    """Rows on which nothing but the counter can make a window stand alone, and those that do.

    Where the motor moves, these are windows off by more than it may be for coming sooner or later.
    """
    calm = [steady(s) for s in problem.stretches]
    moved, size = [moved_rad_s(s) for s in problem.stretches], [np.abs(r) for r in left]
    large = [f & (r > m) for f, r, m in zip(far, size, moved, strict=True)]
    alone = [f & (c | b) for f, c, b in zip(far, calm, large, strict=True)]
    if any(b.any() for b in large):
        usual_rad_s = np.median(np.concatenate([r[b] for r, b in zip(size, large, strict=True)]))
        still = [s.use & (m < usual_rad_s) for s, m in zip(problem.stretches, moved, strict=True)]
        calm = [c | k for c, k in zip(calm, still, strict=True)]
    return calm, alone


def _p_value(windows: LoneWindows, spikes_hz: float) -> float:
    """Probability of as many lone windows where nothing is wrong; 1 for no more than is usual."""
    count = int(np.count_nonzero(windows.alone))
    usual = _usual(spikes_hz, windows.alone.size * windows.window_s)
    if count < usual:
        return 1.0
    return float(poisson.sf(count - 1, usual)) if usual > 0.0 else 0.0


def _usual(spikes_hz: float, duration_s: float) -> float:
    """How many windows stand alone where nothing is wrong: no two days are alike."""
    return _AS_USUAL * spikes_hz * duration_s


def _alone(
    problem: Problem, left: Sequence[Array], effects: Sequence[Applied], spread: float
) -> list[Mask]:
    """Windows that stand alone, by more than what is no count, or than an effect may be off by."""
    far = spiked(problem.stretches, left, problem.noise, near_steps=True, times=PLAIN * spread)
    far = off_steps(problem.stretches, left, far)
    beyond = _beyond(problem, left, far, spread)
    least_rad_s = [
        max(_OF_COUNT * (s.context.count_rad_s or 0.0), _OF_WHOLE * whole_count_rad_s(s))
        for s in problem.stretches
    ]
    changes = problem.change_rad_s(effects)
    parts = zip(beyond, left, least_rad_s, changes, strict=True)
    return [b & (np.abs(r) > np.maximum(least, _off_rad_s(c))) for b, r, least, c in parts]


def _beyond(
    problem: Problem, left: Sequence[Array], rows: Sequence[Mask], spread: float
) -> list[Mask]:
    """Rows, of those given, that are plainly beyond the noise and what is no news.

    Of a rotor that turns on, this moves the windows beside them as well.
    """
    calm = [steady(s) for s in problem.stretches]
    turns = problem.unsure_beside_rad_s([m & c for m, c in zip(rows, calm, strict=True)])
    others = problem.unsure_rad_s([m & ~c for m, c in zip(rows, calm, strict=True)])
    parts = zip(problem.stretches, left, rows, turns, others, strict=True)
    return [
        mask & (np.abs(r) > PLAIN * spread * np.hypot(problem.noise.level_rad_s(s), t + o))
        for s, r, mask, t, o in parts
    ]


def _off_rad_s(change_rad_s: Array) -> Array:
    """Return how far off what an effect does may be: it may also come a window sooner or later."""
    size = maximum_filter1d(np.abs(change_rad_s), _SOON)
    jumps = maximum_filter1d(change_rad_s, _BESIDE) - minimum_filter1d(change_rad_s, _BESIDE)
    return np.asarray(np.maximum(_OF_EFFECT * size, jumps))


def _estimates(effect: SporadicEffect, found: Weighed) -> tuple[Estimate, ...]:
    """Describe the parameters."""
    estimates = []
    for p in effect.parameters:
        low, value, high = found.values[p.name]
        estimates.append(Estimate(p.name, value, low, high, p.unit, p.what))
    return tuple(estimates)
