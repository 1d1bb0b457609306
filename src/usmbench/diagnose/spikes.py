"""Isolated windows far from their neighbours: false counts, and rows that must not sway a fit."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.noise import LAGS, Noise
from usmbench.diagnose.stretches import Mask, Stretch

Array = NDArray[np.float64]

FAR = 6.0  # standard deviations: once in 5·10⁸ windows of normal noise


def spiked(
    stretches: Sequence[Stretch], residuals: Sequence[Array], noise: Noise, *, near_steps: bool
) -> list[Mask]:
    """Return the windows whose residual stands alone.

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
    """
    return [
        _alone(residual, noise.level_rad_s(s)) & (near_steps | _far_from_step(s, noise))
        for s, residual in zip(stretches, residuals, strict=True)
    ]


def _alone(residual: Array, level: Array) -> Mask:
    """Rows far from the middle of the two rows before and the two after, up to two in a row."""
    padded = np.pad(residual, 3, mode="edge")
    around = np.stack([padded[k : k + residual.size] for k in (0, 1, 2, 4, 5, 6)])
    away = residual - np.median(around, axis=0)
    return np.asarray(np.abs(away) > FAR * level, dtype=np.bool_)


def _far_from_step(stretch: Stretch, noise: Noise) -> Mask:
    """Rows on which no step of any size can still act."""
    level = noise.level_rad_s(stretch)
    far: Mask = (stretch.lag >= 2 * LAGS) | (np.abs(stretch.step_rad_s) < level)
    return far
