"""Causes that strike single windows named: those that stand alone, and what sets them apart."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ks_2samp, poisson

from usmbench.diagnose.cutting.stretches import Mask, came_from
from usmbench.diagnose.evidence import NamedCause
from usmbench.diagnose.naming.apart_windows import away_rad_s, scatter_rad_s
from usmbench.diagnose.naming.lone_kinds import lone_kinds
from usmbench.diagnose.naming.ranking import NO_CHANCE, SIGNIFICANT
from usmbench.diagnose.naming.standing_alone import StandingAlone
from usmbench.diagnose.noise.spikes import apart, are_exceptions
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.whole import PLAIN_P_VALUE
from usmbench.diagnose.result import LoneView
from usmbench.model.applied import Applied
from usmbench.model.effects.lone_windows import LoneWindows

Array = NDArray[np.float64]

# Far out without a neighbour, at places that do not repeat each other: fewer may be knocks, or
# where a plan has a rotor start, time and again.
_FEWEST = 3
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
    is_news
        Whether the model does not have it yet, or not as large.
    deviance
        Square of the windows that it may have struck, over the noise's: where the motor moves, of
        those that stand alone, and are no further off than where it runs steadily. Of what is no
        news 0.
    touched
        Windows of each stretch that it may move though they do not stand alone, shape (N,).
    lacks_rad
        By how much a revolution is less by a counter where it is.
    seen
        The windows that stand alone, for a figure.
    """

    applied: Applied
    named: NamedCause
    is_news: bool
    deviance: float
    touched: list[Mask]
    lacks_rad: float
    seen: LoneView


def find_sporadic(
    problem: Problem,
    effects: Sequence[Applied],
    spread: float,
    left_out: Sequence[Sporadic] = (),
) -> Sporadic | None:
    """Name a sporadic cause where enough windows stand alone.

    Parameters
    ----------
    problem
        The problem.
    effects
        The other causes. Where one of them strikes by chance, its scatter covers what stands alone.
    spread
        Standard deviation of the whitened noise: in one that has grown, no window stands alone.
    left_out
        Causes whose windows are left out.
    """
    left = problem.left_rad_s(effects)
    alone = StandingAlone.of(problem, effects, spread)
    rows = np.concatenate(alone.calm)
    lacks_rad = sum(cause.lacks_rad for cause in left_out)
    every = replace(_windows(problem, left, alone), lacks_rad=lacks_rad)
    windows = every.of(rows)
    before = [came_from(s.settled_rad_s, s.step_rad_s, s.lag) for s in problem.stretches]
    places = np.unique(np.concatenate(before)[rows][windows.alone])
    known = problem.known
    p_value = _p_value(windows, known.spikes_hz)
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
    likeliest, *others = lone_kinds(windows)
    near = [likeliest, *(kind for kind in others if kind.is_near)]
    kind = next((k for k in near if k.is_in(known.sporadic)), likeliest)
    is_news = not kind.is_in(known.sporadic)
    oftener = _p_value(windows, known.expected_spikes_hz(with_left_out=False))
    # How often a place of the disc passes is a matter of the plan.
    if oftener <= SIGNIFICANT and not kind.effect.left_out:
        p_value, is_news = oftener, True
    if not (is_news or kind.effect.left_out):
        return None
    rivals = [other for other in (likeliest, *others) if other is not kind]
    ends = np.cumsum([r.size for r in left])[:-1]
    return Sporadic(
        kind.applied,
        kind.named(rivals, p_value),
        is_news,
        _deviance(problem, left, alone) if is_news else 0.0,
        np.split(kind.effect.touched(windows, every), ends),
        kind.effect.lacks_rad(kind.applied.values),
        kind.seen(rivals, windows),
    )


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


def _p_value(windows: LoneWindows, spikes_hz: float) -> float:
    """Probability of as many lone windows where nothing is wrong; 1 for no more than is usual."""
    count = int(np.count_nonzero(windows.alone))
    usual = usual_windows(spikes_hz, windows.alone.size * windows.window_s)
    if count < usual:
        return 1.0
    return float(poisson.sf(count - 1, usual)) if usual > 0.0 else 0.0


def usual_windows(spikes_hz: float, duration_s: float) -> float:
    """Return how many windows stand alone where nothing is wrong: no two days are alike.

    Parameters
    ----------
    spikes_hz
        How often one does in a run with nothing wrong.
    duration_s
        How long the runs are.
    """
    return _AS_USUAL * spikes_hz * duration_s
