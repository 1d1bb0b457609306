"""Blocks of the runs that a fit does not see."""

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.model.linear import memory_windows

BLOCKS, FOLDS = 12, 4  # of a stretch; every fourth block is held out at a time
_MARGIN = 5  # windows beyond the memory of the dynamics


def block_of(stretch: Stretch, count: int = BLOCKS) -> NDArray[np.int64]:
    """Return the number of each row's contiguous block, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    count
        How many blocks it is cut into.
    """
    return np.arange(stretch.context.n) * count // stretch.context.n


def held_out(stretch: Stretch, fold: int, count: int = BLOCKS) -> Mask:
    """Return the rows that a fold scores, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    fold
        Number of the fold, from 0.
    count
        How many blocks the stretch is cut into.
    """
    rows: Mask = block_of(stretch, count) % FOLDS == fold
    return rows


def held_apart(stretch: Stretch, fold: int) -> tuple[Mask, Mask]:
    """Return what a fold scores, and what its fit leaves out: that, and what is tied to it.

    Of a short stretch of a slow motor the blocks are fewer, lest none of it be left to fit.

    Parameters
    ----------
    stretch
        The stretch.
    fold
        Number of the fold, from 0.

    Returns
    -------
    scored, left_out
        Shape (N,) each.
    """
    gap = memory_windows(stretch.context.linear) + _MARGIN
    scored = held_out(stretch, fold, int(np.clip(stretch.context.n // gap, FOLDS, BLOCKS)))
    reach = np.convolve(scored.astype(np.float64), np.ones(2 * gap + 1), mode="full")
    left_out: Mask = reach[gap : gap + scored.size] > 0.5
    return scored, left_out
