"""The time step of rows whose clock may jitter, or stop for a while."""

import numpy as np
from numpy.typing import NDArray

from usmbench.runs.record import Column

UNKNOWN_S = 0.01  # the paper's windows, where a single row tells nothing
# Clocks that jitter differ by a part in a thousand; by this, a lag's exp(−T/τ) by 0.005/e at most.
_ALIKE = 5e-3
_GAP_WINDOWS = 1.5  # a step of the clock beyond so many windows is a break in the record
_NEAR = (0.5, 1.5)  # of the median: what is outside is a break in the record


def usual_step_s(t_s: Column) -> float:
    """Return the mean step of the clock, breaks aside.

    The median of steps that jitter by a twentieth is off by a part in a thousand; their mean is
    the time between the ends over the number of steps.

    Parameters
    ----------
    t_s
        Time of each row, rising, shape (N,).
    """
    steps_s = np.diff(t_s)
    if not steps_s.size:
        return UNKNOWN_S
    middle_s = float(np.median(steps_s))
    low_s, high_s = np.multiply(_NEAR, middle_s)
    near = (steps_s >= low_s) & (steps_s <= high_s)
    return float(np.mean(steps_s[near])) if near.any() else middle_s


def breaks(t_s: Column, window_s: float) -> NDArray[np.intp]:
    """Return the rows before which the record breaks off, shape (K,).

    Parameters
    ----------
    t_s
        End of each window, rising, shape (N,).
    window_s
        Duration of a window.
    """
    return np.flatnonzero(np.diff(t_s) > _GAP_WINDOWS * window_s) + 1


def alike(window_s: float, other_s: float) -> bool:
    """Return whether two durations of windows are the same but for what clocks jitter.

    Parameters
    ----------
    window_s, other_s
        The durations.
    """
    return abs(window_s / other_s - 1.0) <= _ALIKE
