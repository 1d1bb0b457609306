"""How far a window has to be from those beside it to be no noise, nor what a model may miss."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.noise.rotor_states import runs_on, steady
from usmbench.diagnose.noise.spikes import PLAIN, apart
from usmbench.diagnose.residual.problem import Problem
from usmbench.identify.like_phases import median_at_like_phases

Array = NDArray[np.float64]

# What windows are off by shows in those that do not stand alone, nine in ten; some thousand tell.
# Nothing measured sets these.
_ALONE, _DOUBLE, _FEWEST, _ENOUGH = 0.1, 2.0, 40, 4000
_OVER_AWAY = 2.04  # standard deviation over the median of `away_rad_s`, of a white normal noise


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
    least = least_rad_s(problem, left, rows, spread)
    return [m & (away_rad_s(r) > least_) for m, r, least_ in zip(rows, left, least, strict=True)]


def least_rad_s(
    problem: Problem, left: Sequence[Array], rows: Sequence[Mask], spread: float
) -> list[Array]:
    """Return how far from those beside it a row is no more by noise and what is no news.

    Parameters
    ----------
    problem, left, rows, spread
        As in `beyond`.

    Returns
    -------
    list of Array
        By stretch, shape (N,) each; of rows that are not asked for by the noise alone.
    """
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


def away_rad_s(residual_rad_s: Array) -> Array:
    """Return how far each row is at least from those beside it, shape (N,).

    Parameters
    ----------
    residual_rad_s
        What is left of a stretch, shape (N,).
    """
    return np.asarray(np.min(np.abs(apart(residual_rad_s)), axis=0))


def scatter_rad_s(stretches: Sequence[Stretch], away: Sequence[Array]) -> list[Array]:
    """Return the standard deviation of windows at about the phase of each, by stretch, (N,).

    Parameters
    ----------
    stretches
        The stretches.
    away
        How far each of their rows is from those beside it, in rad/s, shape (N,).
    """
    phase_deg = np.concatenate([s.context.phase_deg for s in stretches])
    around = _OVER_AWAY * median_at_like_phases(np.concatenate(away), phase_deg)
    return np.split(around, np.cumsum([s.context.n for s in stretches])[:-1])


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
    away = np.concatenate([away_rad_s(r) for r in left]) / level
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
