"""Rows at about the same phase, at whatever time these were, and phases that are one."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

Array = NDArray[np.float64]

SAME_PHASE = 2e-5
"""Of the range, for two phases to be one but for rounding."""
LEVELS = 60
"""Phases of a staircase at most; a record that glides has more."""
_NEAREST = 41  # rows; nothing measured sets it
_TELLING = 10_000  # rows at the beginning that mostly tell whether a record glides


def median_at_like_phases(values: Array, phase_deg: Array) -> Array:
    """Return the median of the rows nearest in phase to each, shape (N,), in the values' unit.

    Parameters
    ----------
    values
        One a row, shape (N,).
    phase_deg
        Its phase, shape (N,).
    """
    order = np.argsort(phase_deg, kind="stable")
    around = np.empty_like(values)
    around[order] = median_filter(values[order], _NEAREST)
    return around


def distinct_deg(phase_deg: Array) -> Array:
    """Return phases without those that are others but for rounding, rising, shape (M,).

    Parameters
    ----------
    phase_deg
        Phases in any order, shape (N,).
    """
    rising_deg = np.unique(phase_deg)
    apart = np.diff(rising_deg, prepend=-np.inf) > SAME_PHASE * np.ptp(rising_deg)
    return np.asarray(rising_deg[apart])


def merged_deg(phases_deg: Sequence[Array]) -> list[Array]:
    """Return phases of which those are equal that are others but for rounding.

    Only of few levels: a record that glides has phases as near to each other as any.

    Parameters
    ----------
    phases_deg
        Phases in any order, shape (N_k,) each.
    """
    if distinct_deg(np.concatenate([p[:_TELLING] for p in phases_deg])).size > LEVELS:
        return list(phases_deg)  # spares a long record the sorting
    every_deg = np.concatenate(phases_deg)
    levels_deg = distinct_deg(every_deg)
    if levels_deg.size > LEVELS:
        return list(phases_deg)
    merged = [levels_deg[np.searchsorted(levels_deg, p, side="right") - 1] for p in phases_deg]
    moved_deg = np.max(np.abs(np.concatenate(merged) - every_deg))
    return merged if moved_deg <= SAME_PHASE * np.ptp(every_deg) else list(phases_deg)
