"""Causes that strike single windows named: those that stand alone, and what sets them apart."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ks_2samp, poisson

from usmbench.diagnose.cutting.stretches import Mask, came_from
from usmbench.diagnose.evidence import Estimate, NamedCause
from usmbench.diagnose.naming.apart_windows import away_rad_s, beyond, scatter_rad_s
from usmbench.diagnose.naming.ranking import NO_CHANCE, SIGNIFICANT, TELLING
from usmbench.diagnose.naming.standing_alone import StandingAlone, clear_rows
from usmbench.diagnose.noise.rotor_states import moved_rad_s, steady
from usmbench.diagnose.noise.spikes import apart, are_exceptions
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.whole import PLAIN_P_VALUE
from usmbench.model.applied import Applied
from usmbench.model.effects.lone_windows import LoneWindows, SporadicEffect, Weighed
from usmbench.model.effects.registry import library

Array = NDArray[np.float64]

# Far out without a neighbour, at places that do not repeat each other: fewer may be knocks, or
# where a plan has a rotor start, time and again.
_FEWEST = 3
_TOLD = 2  # healthy runs have one now and then
_BEYOND = 2.0  # times the highest speed
_OF_SCATTER = 5.0  # standard deviations of the windows around
_AS_USUAL = 2.0  # times the rate of the identified runs: their plans differ


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
    touched
        Windows of each stretch that it may move though they do not stand alone, shape (N,).
    """

    applied: Applied
    named: NamedCause
    deviance: float
    touched: list[Mask]


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
    alone = StandingAlone.of(problem, effects, spread)
    rows = np.concatenate(alone.calm)
    every = _windows(problem, left, alone)
    windows = every.of(rows)
    before = [came_from(s.settled_rad_s, s.step_rad_s, s.lag) for s in problem.stretches]
    places = np.unique(np.concatenate(before)[rows][windows.alone])
    p_value = _p_value(windows, problem.known.spikes_hz)
    if places.size < _FEWEST or p_value > SIGNIFICANT:
        return None
    if not are_exceptions(problem.stretches, left, alone.plain, alone.calm):
        return None
    if (
        _strikes_slow_ones(windows)
        or _comes_with_steps(problem, alone)
        or _among_scatter(problem, left, alone)
    ):
        return None
    kinds = [effect for effect in library() if isinstance(effect, SporadicEffect)]
    weighed = [(effect, effect.weigh(windows)) for effect in kinds]
    weighed.sort(key=lambda pair: -pair[1].log_likelihood)
    (effect, best), *others = weighed
    near = [e.name for e, w in others if 2.0 * (best.log_likelihood - w.log_likelihood) < TELLING]
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
    touched = np.split(effect.touched(windows, every), np.cumsum([r.size for r in left])[:-1])
    return Sporadic(applied, named, _deviance(problem, left, alone), touched)


def _windows(problem: Problem, left: Sequence[Array], alone: StandingAlone) -> LoneWindows:
    """Return all windows, stretch after stretch."""
    stretches = problem.stretches
    turns_rad = [0.5 * np.abs(s.speed_rad_s) * s.context.window_s for s in stretches]
    middles_rad = np.concatenate([s.context.turned_rad(s.speed_rad_s) for s in stretches])
    return LoneWindows(
        np.concatenate([s.simulated_rad_s for s in stretches]),
        # A counter's steps leave every window of a hold off by the same part of a count.
        np.concatenate([np.mean(apart(r), axis=0) for r in left]),
        np.concatenate(alone.plain),
        middles_rad - np.concatenate(turns_rad),
        middles_rad + np.concatenate(turns_rad),
        np.concatenate([np.full(s.context.n, s.run) for s in stretches]),
        stretches[0].context.window_s,
    )


def _strikes_slow_ones(windows: LoneWindows) -> bool:
    """Whether lone windows are slower than chance has them: a counter errs by time or by count.

    A few prove nothing: a plan may be slow just where they strike.
    """
    fast = np.abs(windows.speed_rad_s)
    struck = fast[windows.alone]
    # Its exact way warns where it fails.
    p_value = ks_2samp(struck, fast, alternative="greater", method="asymp").pvalue
    return bool(p_value < NO_CHANCE)


def _comes_with_steps(problem: Problem, alone: StandingAlone) -> bool:
    """Whether lone windows begin with larger steps than chance has them: a motor that lags."""
    steps = np.concatenate(
        [np.where(s.lag == 0, np.abs(s.step_rad_s), 0.0) for s in problem.stretches]
    )
    calm, plain = np.concatenate(alone.calm), np.concatenate(alone.plain)
    p_value = ks_2samp(steps[plain], steps[calm | plain], alternative="less", method="asymp").pvalue
    return bool(p_value < PLAIN_P_VALUE)


def _among_scatter(problem: Problem, left: Sequence[Array], alone: StandingAlone) -> bool:
    """Whether at the phases of most lone windows the others scatter, too: a phase that trembles."""
    away = [away_rad_s(r) for r in left]
    scatter = scatter_rad_s(problem.stretches, away)
    far = [a[p] > _OF_SCATTER * s[p] for a, s, p in zip(away, scatter, alone.plain, strict=True)]
    return bool(np.mean(np.concatenate(far)) < 0.5)


def _deviance(problem: Problem, left: Sequence[Array], alone: StandingAlone) -> float:
    """Square of the windows that stand alone, no further off than the plain ones, over noise's."""
    plain = zip(left, alone.plain, alone.calm, strict=True)
    most_rad_s = max(float(np.max(np.abs(r[p & c]), initial=0.0)) for r, p, c in plain)
    deviance = 0.0
    for stretch, residual, mask in zip(problem.stretches, left, alone.every, strict=True):
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
    clear = clear_rows(problem, effects)
    not_judged = [
        (steady(s) | s.use & (np.abs(r) > moved_rad_s(s))) & ~mask & c
        for s, r, mask, c in zip(problem.stretches, left, problem.masks, clear, strict=True)
    ]
    far = beyond(problem, left, not_judged, spread)
    for stretch, rows, residual in zip(problem.stretches, far, left, strict=True):
        off_rad_s = np.abs(residual[rows])
        duration_s = stretch.context.n * stretch.context.window_s
        top_rad_s = float(np.max(np.abs(stretch.simulated_rad_s), initial=0.0))
        many = off_rad_s.size >= max(_TOLD, _usual(problem.known.spikes_hz, duration_s))
        # No motor does that, not even once.
        if many or np.max(off_rad_s, initial=0.0) > _BEYOND * top_rad_s > 0.0:
            found.append(
                f"{stretch.name}: windows that stand alone are not judged: "
                f"{off_rad_s.size}, off by up to {np.max(off_rad_s):.3g} rad/s; no cause is named "
                "for them"
            )
    return found


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


def _estimates(effect: SporadicEffect, found: Weighed) -> tuple[Estimate, ...]:
    """Describe the parameters."""
    estimates = []
    for p in effect.parameters:
        low, value, high = found.values[p.name]
        estimates.append(Estimate(p.name, value, low, high, p.unit, p.what))
    return tuple(estimates)
