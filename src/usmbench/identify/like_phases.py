"""Rows held to those at about the same phase, at whatever time these were."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

Array = NDArray[np.float64]

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
