"""What follows another value with a time constant: a store, a smoothing, a temperature."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]


def lagged(values: Array, kept: float, before: float) -> Array:
    """Return values behind a first-order lag that is 1 where they stay, shape (N,).

    Parameters
    ----------
    values
        Values, each held through its window, shape (N,).
    kept
        Share of its difference from a value that the lag keeps in a window: exp(−window / time
        constant).
    before
        Where the lag was before the first of them.
    """
    behind, _ = lfilter([1.0 - kept], [1.0, -kept], values, zi=[kept * before])
    return np.asarray(behind, dtype=np.float64)
