"""Windows that stand alone: all of them, and those of which only the counter can be the cause."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.naming.apart_windows import away_rad_s, beyond, least_rad_s
from usmbench.diagnose.naming.chance import chancy_of, struck_by
from usmbench.diagnose.noise.rotor_states import moved_rad_s, runs_on, steady, whole_count_rad_s
from usmbench.diagnose.noise.spikes import PLAIN, off_steps, spiked
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.base import PHYSICS

Array = NDArray[np.float64]

# A counter is off by whole ones; where speeds are whole counts, rounding makes one of every window.
_OF_COUNT, _OF_WHOLE = 0.25, 1.5
# What an effect's form may be off by is no count, nor what it changes by beside the window.
_OF_EFFECT, _SOON, _BESIDE = 3.0 * PHYSICS, 3, 5  # share; windows around
# Of the windows: false counts are as often ahead of a move as behind it. Nothing measured sets it.
_AHEAD = 0.25


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
        left, clear = problem.left_rad_s(effects), clear_rows(problem, effects)
        found = _alone(problem, left, effects, spread)
        every = [a & c for a, c in zip(found, clear, strict=True)]
        calm, plain = _plain(problem, left, every)
        calm = [rows & c for rows, c in zip(calm, clear, strict=True)]
        calm = _would_show(problem, left, effects, calm, plain, spread)
        return cls(every, calm, [p & c for p, c in zip(plain, calm, strict=True)])


def clear_rows(problem: Problem, effects: Sequence[Applied]) -> list[Mask]:
    """Return the rows of each stretch that no cause strikes by chance, shape (N,).

    Parameters
    ----------
    problem
        The problem.
    effects
        The causes that are named.
    """
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
    return [b & (away_rad_s(r) > n) for b, r, n in zip(plainly, left, no_count, strict=True)]


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
    away = [away_rad_s(r) for r in left]
    sizes_rad_s = np.concatenate([a[p] for a, p in zip(away, plain, strict=True)])
    if not sizes_rad_s.size:
        return list(calm)
    usual_rad_s = np.median(sizes_rad_s)
    least = least_rad_s(problem, left, calm, spread)
    parts = zip(calm, least, _no_count_rad_s(problem, effects), strict=True)
    return [rows & (np.maximum(most, none) < usual_rad_s) for rows, most, none in parts]


def _off_rad_s(change_rad_s: Array) -> Array:
    """Return how far off what an effect does may be: it may also come a window sooner or later."""
    size = maximum_filter1d(np.abs(change_rad_s), _SOON)
    jumps = maximum_filter1d(change_rad_s, _BESIDE) - minimum_filter1d(change_rad_s, _BESIDE)
    return np.asarray(np.maximum(_OF_EFFECT * size, jumps))
