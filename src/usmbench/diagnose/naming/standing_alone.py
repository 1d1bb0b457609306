"""Windows that stand alone: all of them, and those of which only the counter can be the cause."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.stats import norm

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.naming.chance import chancy_of, struck_by
from usmbench.diagnose.noise.spikes import (
    PLAIN,
    apart,
    moved_rad_s,
    off_steps,
    runs_on,
    spiked,
    steady,
    whole_count_rad_s,
)
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.effects.base import PHYSICS
from usmbench.model.extended import Applied

Array = NDArray[np.float64]

# A counter is off by whole ones; where speeds are whole counts, rounding makes one of every window.
_OF_COUNT, _OF_WHOLE = 0.25, 1.5
# What an effect's form may be off by is no count, nor what it changes by beside the window.
_OF_EFFECT, _SOON, _BESIDE = 3.0 * PHYSICS, 3, 5  # share; windows around
_AHEAD = 0.25  # of the windows: false counts are as often ahead of a move as behind it
# What windows are off by shows in those that do not stand alone; some thousand of them tell.
# Nothing measured sets these or the share above.
_ALONE, _DOUBLE, _FEWEST, _ENOUGH = 0.1, 2.0, 40, 4000


@dataclass(frozen=True, slots=True)
class StandingAlone:
    """Windows of each stretch that stand alone, shape (N,).

    Parameters
    ----------
    every
        All of them, where no other cause strikes by chance.
    calm
        Rows on which nothing but the counter can make a window stand alone.
    plain
        Those of them that do.
    """

    every: list[Mask]
    calm: list[Mask]
    plain: list[Mask]

    @classmethod
    def of(cls, problem: Problem, effects: Sequence[Applied], spread: float) -> "StandingAlone":
        """Return the windows that stand alone.

        Parameters
        ----------
        problem
            The problem.
        effects
            The causes that are named.
        spread
            Standard deviation of the whitened noise, at least 1.
        """
        left, clear = problem.left_rad_s(effects), _clear(problem, effects)
        found = _alone(problem, left, effects, spread)
        every = [a & c for a, c in zip(found, clear, strict=True)]
        calm, plain = _plain(problem, left, every)
        calm = [rows & c for rows, c in zip(calm, clear, strict=True)]
        calm = _would_show(problem, left, effects, calm, plain, spread)
        return cls(every, calm, [p & c for p, c in zip(plain, calm, strict=True)])


def beyond(
    problem: Problem, left: Sequence[Array], rows: Sequence[Mask], spread: float
) -> list[Mask]:
    """Return the rows, of those given, that are plainly beyond the noise and what is no news.

    Of a rotor that turns on, this moves the windows beside them as well.

    Parameters
    ----------
    problem
        The problem.
    left
        What is left of each stretch, in rad/s, shape (N,).
    rows
        Those to look at, shape (N,).
    spread
        Standard deviation of the whitened noise, at least 1.
    """
    least = _least_rad_s(problem, left, rows, spread)
    return [m & (_away(r) > least_) for m, r, least_ in zip(rows, left, least, strict=True)]


def _least_rad_s(
    problem: Problem, left: Sequence[Array], rows: Sequence[Mask], spread: float
) -> list[Array]:
    """Return how far from those beside it a row is no more by noise and what is no news, (N,)."""
    calm = [steady(s) | runs_on(s) for s in problem.stretches]
    turns = problem.unsure_beside_rad_s([m & c for m, c in zip(rows, calm, strict=True)])
    others = problem.unsure_rad_s([m & ~c for m, c in zip(rows, calm, strict=True)])
    level = [problem.noise.level_rad_s(s) for s in problem.stretches]
    shown = _shown(problem, left, calm)
    return [
        PLAIN * spread * np.hypot(lv, shown[_octave(t / lv, shown.size)] * t + o)
        for lv, t, o in zip(level, turns, others, strict=True)
    ]


def _octave(times: Array, n: int) -> NDArray[np.intp]:
    """Return which of n octaves from 1 on numbers are in, the last of all beyond, shape (N,)."""
    return np.clip(np.log2(np.maximum(times, 1.0)), 0, n - 1).astype(np.intp)


def _away(residual_rad_s: Array) -> Array:
    """Return how far each row is at least from those beside it, shape (N,)."""
    return np.asarray(np.min(np.abs(apart(residual_rad_s)), axis=0))


def _shown(problem: Problem, left: Sequence[Array], calm: Sequence[Mask]) -> Array:
    """Return which share of what a rotor that turns on may be off by it is, 1 at most.

    What is no news says how far the windows of any run may be from those beside them. In this run
    few stand alone, so that the others say how far they are, of which as much is unsure or more:
    what follows small steps tells nothing of what follows large ones.

    Returns
    -------
    Array
        One where as much is unsure as the noise, twice that, and so on, shape (K,); 1 at the end.
    """
    every = max(1, sum(int(np.count_nonzero(c)) for c in calm) // _ENOUGH)
    some = [c & (np.arange(c.size) % every == 0) for c in calm]
    level = np.concatenate([problem.noise.level_rad_s(s) for s in problem.stretches])
    unsure = np.concatenate(problem.unsure_beside_rad_s(some)) / level
    away = np.concatenate([_away(r) for r in left]) / level
    octaves = np.arange(np.ceil(np.log2(np.max(unsure, initial=1.0))))
    return np.array([*(_share_of(away, unsure, 2.0**k) for k in octaves), 1.0])


def _share_of(away: Array, unsure: Array, least: float) -> float:
    """Return which share of what is unsure windows are off by, both in noise, shape (N,)."""
    tells = unsure > least
    if np.count_nonzero(tells) < _FEWEST:
        return 1.0
    for share in np.linspace(0.0, 0.5, 11):
        most = np.quantile(away[tells] / np.hypot(1.0, share * unsure[tells]), 1.0 - _ALONE)
        if most < norm.isf(0.5 * _ALONE):
            return float(_DOUBLE * share)
    return 1.0


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

    Where the motor moves, these are windows off by more than it may be for coming sooner or later,
    and where it runs on, of any size that are not all behind the move, as a late command's are.
    """
    calm = [steady(s) for s in problem.stretches]
    running = [runs_on(s) & ~c for s, c in zip(problem.stretches, calm, strict=True)]
    if not _all_late(problem.stretches, left, [f & m for f, m in zip(far, running, strict=True)]):
        calm = [c | m for c, m in zip(calm, running, strict=True)]
    moved, size = [moved_rad_s(s) for s in problem.stretches], [np.abs(r) for r in left]
    large = [f & (r > m) for f, r, m in zip(far, size, moved, strict=True)]
    alone = [f & (c | b) for f, c, b in zip(far, calm, large, strict=True)]
    if any(b.any() for b in large):
        usual_rad_s = np.median(np.concatenate([r[b] for r, b in zip(size, large, strict=True)]))
        still = [s.use & (m < usual_rad_s) for s, m in zip(problem.stretches, moved, strict=True)]
        calm = [c | k for c, k in zip(calm, still, strict=True)]
    return calm, alone


def _all_late(stretches: Sequence[Stretch], left: Sequence[Array], far: Sequence[Mask]) -> bool:
    """Return whether hardly any window is ahead of the move: commands come late, never early."""
    parts = zip(stretches, left, far, strict=True)
    ahead = np.concatenate([(r * np.gradient(s.simulated_rad_s) > 0.0)[f] for s, r, f in parts])
    return bool(np.count_nonzero(ahead) < max(1.0, _AHEAD * ahead.size))


def _alone(
    problem: Problem, left: Sequence[Array], effects: Sequence[Applied], spread: float
) -> list[Mask]:
    """Windows that stand alone, by more than what is no count, or than an effect may be off by."""
    far = spiked(problem.stretches, left, problem.noise, near_steps=True, times=PLAIN * spread)
    far = off_steps(problem.stretches, left, far)
    plainly = beyond(problem, left, far, spread)
    no_count = _no_count_rad_s(problem, effects)
    return [b & (_away(r) > n) for b, r, n in zip(plainly, left, no_count, strict=True)]


def _no_count_rad_s(problem: Problem, effects: Sequence[Applied]) -> list[Array]:
    """Return how far off a row of each stretch is for less than a count, or by effects, (N,)."""
    changes = problem.change_rad_s(effects)
    return [
        np.maximum(
            max(_OF_COUNT * (s.context.count_rad_s or 0.0), _OF_WHOLE * whole_count_rad_s(s)),
            _off_rad_s(c),
        )
        for s, c in zip(problem.stretches, changes, strict=True)
    ]


def _would_show(
    problem: Problem,
    left: Sequence[Array],
    effects: Sequence[Applied],
    calm: Sequence[Mask],
    plain: Sequence[Mask],
    spread: float,
) -> list[Mask]:
    """Rows on which a window of the usual size would stand alone: how often, they alone tell."""
    away = [_away(r) for r in left]
    sizes_rad_s = np.concatenate([a[p] for a, p in zip(away, plain, strict=True)])
    if not sizes_rad_s.size:
        return list(calm)
    usual_rad_s = np.median(sizes_rad_s)
    least = _least_rad_s(problem, left, calm, spread)
    parts = zip(calm, least, _no_count_rad_s(problem, effects), strict=True)
    return [rows & (np.maximum(most, none) < usual_rad_s) for rows, most, none in parts]


def _off_rad_s(change_rad_s: Array) -> Array:
    """Return how far off what an effect does may be: it may also come a window sooner or later."""
    size = maximum_filter1d(np.abs(change_rad_s), _SOON)
    jumps = maximum_filter1d(change_rad_s, _BESIDE) - minimum_filter1d(change_rad_s, _BESIDE)
    return np.asarray(np.maximum(_OF_EFFECT * size, jumps))
