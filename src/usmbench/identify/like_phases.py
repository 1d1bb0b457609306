"""Rows at about the same phase, at whatever time these were, and phases that are one."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

Array = NDArray[np.float64]

SAME_PHASE = 2e-5
"""Of the range, for two phases to be one but for rounding."""
_NEAREST = 41  # rows; nothing measured sets it


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
