"""Isolated windows far from their neighbours: miscounts, and rows that must not sway a fit."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.noise.noise_model import LAGS, Noise
from usmbench.diagnose.noise.rotor_states import steady
from usmbench.identify.wild_rows import WILD_TIMES

Array = NDArray[np.float64]

_PARTS = 8  # of the speeds, from slow to fast
_MOST_ALONE, _MOST_IN_PART = 0.1, 0.25  # more is no exception
_FEWEST_STEPS = 5  # a few may be struck by chance; nothing measured sets it
_BESIDE, _AS_OTHERS = 11, 0.5  # windows; of what a window is off by
PLAIN = 7.0  # so far that only a miscount remains
_FAR = 6.0  # standard deviations: once in 5·10⁸ windows of normal noise


def spiked(
    stretches: Sequence[Stretch],
    residuals: Sequence[Array],
    noise: Noise,
    *,
    near_steps: bool,
    times: float = _FAR,
) -> list[Mask]:
    """Return the windows whose residual stands alone, and those that no motor makes.

    Parameters
    ----------
    stretches
        The stretches.
    residuals
        Residual of each.
    noise
        The noise in force.
    near_steps
        Whether windows shortly after a step may be called; before a delay or a lag is ruled out
        they may not, both leave single windows there.
    times
        Standard deviations from the neighbours.
    """
    return [
        wild | _alone(r, times * noise.level_rad_s(s)) & (near_steps | _far_from_step(s, noise))
        for s, r, wild in zip(stretches, residuals, _wild(stretches, residuals), strict=True)
    ]


def count_steady(stretches: Sequence[Stretch], far: Sequence[Mask]) -> tuple[int, int]:
    """Return how many steady windows stand alone, and how many there are.

    Parameters
    ----------
    stretches
        The stretches.
    far
        Windows that stand alone.
    """
    rows = [steady(s) for s in stretches]
    hit = sum(int(np.count_nonzero(f & r)) for f, r in zip(far, rows, strict=True))
    return hit, sum(int(np.count_nonzero(r)) for r in rows)


def are_exceptions(
    stretches: Sequence[Stretch],
    residuals: Sequence[Array],
    alone: Sequence[Mask],
    calm: Sequence[Mask],
) -> bool:
    """Return whether nothing but chance decides which calm windows stand alone.

    They are few at every speed, and those at like phases are not off as they are.

    Parameters
    ----------
    stretches
        The stretches.
    residuals
        Residual of each, in rad/s, shape (N,).
    alone
        The windows of each that stand alone, shape (N,).
    calm
        Rows of each to look at, shape (N,).
    """
    far, off, speed, phase = (
        _joined(columns, calm)
        for columns in (
            alone,
            [_beside_neighbours(r) for r in residuals],
            [np.abs(s.simulated_rad_s) for s in stretches],
            [s.context.phase_deg for s in stretches],
        )
    )
    if not far.size:
        return True
    if np.mean(far) > _MOST_ALONE:
        return False
    parts = np.array_split(far[np.argsort(speed, kind="stable")], _PARTS)
    if max(float(np.mean(part)) for part in parts if part.size) > _MOST_IN_PART:
        return False
    return not hang_together(off, far, np.argsort(phase, kind="stable"))


def off_steps(
    stretches: Sequence[Stretch], residuals: Sequence[Array], alone: Sequence[Mask]
) -> list[Mask]:
    """Leave out the windows beside steps where most are off as those beside like steps are.

    A delay in a staircase leaves windows that stand alone, and they are no exceptions; nor are
    those before its steps where the clocks of command and counter differ. Where it differs from
    step to step, so do they, but they come with many of the steps.

    Parameters
    ----------
    stretches
        The stretches.
    residuals
        Residual of each, in rad/s, shape (N,).
    alone
        The windows of each that stand alone, shape (N,).
    """
    moments = [_from_step(s) for s in stretches]
    beside = [s.use & (lag < LAGS) for s, (lag, _) in zip(stretches, moments, strict=True)]
    off, far, lag, step = (
        _joined(columns, beside)
        for columns in (
            [_beside_neighbours(r) for r in residuals],
            alone,
            [m[0] for m in moments],
            [m[1] for m in moments],
        )
    )
    if not (_come_with_steps(far, lag) or hang_together(off, far, np.lexsort((step, lag)))):
        return list(alone)
    wild = _wild(stretches, residuals)
    return [mask & (w | ~b) for mask, w, b in zip(alone, wild, beside, strict=True)]


def _wild(stretches: Sequence[Stretch], residuals: Sequence[Array]) -> list[Mask]:
    """Return the windows that are off by more than any motor of a model's size turns.

    Where many are, the motor turns though the model stands.
    """
    highest_rad_s = max(float(np.max(np.abs(s.simulated_rad_s))) for s in stretches)
    wild = [np.abs(r) > WILD_TIMES * highest_rad_s for r in residuals]
    if np.mean(np.concatenate(wild)) > _MOST_ALONE:
        return [np.zeros_like(rows) for rows in wild]
    return wild


def _come_with_steps(alone: Mask, lag: NDArray[np.int64]) -> bool:
    """Return whether windows stand alone as long after, or before, many of the steps."""
    struck, steps = (np.bincount(rows + 1, minlength=LAGS + 1) for rows in (lag[alone], lag))
    return bool(np.any((struck >= _FEWEST_STEPS) & (struck > _MOST_IN_PART * steps)))


def _from_step(stretch: Stretch) -> tuple[NDArray[np.int64], Array]:
    """Return windows since a step and its size, shape (N,) each; -1 in the last before the next."""
    lag, step_rad_s = stretch.lag.copy(), stretch.step_rad_s.copy()
    before = np.flatnonzero((lag[:-1] > 0) & (lag[1:] == 0))
    lag[before], step_rad_s[before] = -1, step_rad_s[before + 1]
    return lag, step_rad_s


def _joined(columns: Sequence[NDArray[Any]], rows: Sequence[Mask]) -> NDArray[Any]:
    """Return some rows of every stretch, end to end, shape (sum of rows,)."""
    return np.concatenate([column[r] for column, r in zip(columns, rows, strict=True)])


def hang_together(off_rad_s: Array, alone: Mask, order: NDArray[np.intp]) -> bool:
    """Return whether most windows that stand alone are off as those beside them: no chance.

    Parameters
    ----------
    off_rad_s
        By what each window is off, shape (N,).
    alone
        Which windows stand alone, shape (N,).
    order
        The windows in an order that puts like ones beside each other, shape (N,).
    """
    off, far = off_rad_s[order], alone[order]
    if not far.any():
        return False
    alike = median_filter(off, _BESIDE) * off > _AS_OTHERS * off**2
    return bool(np.mean(alike[far]) > 0.5)


def apart(residual_rad_s: Array) -> tuple[Array, Array]:
    """Return how far each row is from the three before and from the three after, in rad/s, (N,).

    Parameters
    ----------
    residual_rad_s
        The residual, shape (N,).
    """
    padded = np.pad(residual_rad_s, 3, mode="edge")
    middle = np.median(sliding_window_view(padded, 3), axis=1)
    return residual_rad_s - middle[: residual_rad_s.size], residual_rad_s - middle[4:]


def _beside_neighbours(residual_rad_s: Array) -> Array:
    """How far each row is from those before or those after, whichever are nearer, (N,)."""
    before, after = apart(residual_rad_s)
    return np.where(np.abs(before) < np.abs(after), before, after)


def _alone(residual: Array, least: Array) -> Mask:
    """Rows far from those before and those after, and on one side of both, up to two in a row.

    A gain that is off leaves another error after a reversal than before it, and no spike.
    """
    before, after = apart(residual)
    away = np.minimum(np.abs(before), np.abs(after))
    return np.asarray((away > least) & (before * after > 0.0), dtype=np.bool_)


def _far_from_step(stretch: Stretch, noise: Noise) -> Mask:
    """Rows on which no step of any size can still act."""
    level = noise.level_rad_s(stretch)
    far: Mask = (stretch.lag >= 2 * LAGS) | (np.abs(stretch.step_rad_s) < level)
    return far
