"""Blocks of the runs that a fit does not see."""

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.model.linear import memory_windows

BLOCKS, FOLDS = 12, 4  # of a stretch; every fourth block is held out at a time
_MARGIN = 5  # windows beyond the memory of the dynamics


def block_of(stretch: Stretch) -> NDArray[np.int64]:
    """Return the number of each row's contiguous block, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    """
    return np.arange(stretch.context.n) * BLOCKS // stretch.context.n


def held_out(stretch: Stretch, fold: int) -> Mask:
    """Return the rows that a fold scores, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    fold
        Number of the fold, from 0.
    """
    rows: Mask = block_of(stretch) % FOLDS == fold
    return rows


def unseen_from(stretch: Stretch, fold: int) -> Mask:
    """Return the rows that a fold's fit leaves out: what it scores, and what is tied to it.

    Parameters
    ----------
    stretch
        The stretch.
    fold
        Number of the fold, from 0.
    """
    rows, gap = held_out(stretch, fold), memory_windows(stretch.context.linear) + _MARGIN
    reach = np.convolve(rows.astype(np.float64), np.ones(2 * gap + 1), mode="full")
    wide: Mask = reach[gap : gap + rows.size] > 0.5
    return wide
