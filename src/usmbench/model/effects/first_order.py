"""The first-order lag behind a delay, exactly, for speeds averaged over windows."""

import math
from dataclasses import replace

import numpy as np

from usmbench.model.effects.base import Array
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import dead_time_s, time_constant_s

_SAME = 0.03  # largest difference of a coefficient that still is the same lag
_FASTEST = 1e-3  # of a window: a lag faster than this is none


def lag_and_delay_s(linear: LinearPart, window_s: float) -> tuple[float, float] | None:
    """Return the lag and the delay of a linear part that is nothing else, or None.

    Parameters
    ----------
    linear
        The linear part.
    window_s
        Duration of a window.
    """
    tau_s, delay_s = time_constant_s(linear), dead_time_s(linear)
    if tau_s is None or delay_s is None or delay_s < -_SAME * window_s:
        return None
    delay_s = max(delay_s, 0.0)
    same = first_order(tau_s, delay_s, window_s)
    n = 4 + same.dead_time_windows + same.b.size + linear.dead_time_windows + linear.b.size
    near = np.max(np.abs(_padded(linear, n) - _padded(same, n))) < _SAME
    return (tau_s, delay_s) if near and linear.a.size == 1 else None


def first_order(tau_s: float, delay_s: float, window_s: float) -> LinearPart:
    """Return the linear part of a lag behind a delay.

    A step at the start of a window acts for u in the window in which the delay ends, which then
    averages u/T − (τ/T)(1 − exp(−u/τ)); in each window after, the distance to the end shrinks by
    p = exp(−T/τ).

    Parameters
    ----------
    tau_s
        Time constant τ.
    delay_s
        Delay.
    window_s
        Duration T of a window.
    """
    tau = max(tau_s / window_s, _FASTEST)
    whole = int(delay_s / window_s)
    acts = 1.0 - (delay_s / window_s - whole)
    pole, left = math.exp(-1.0 / tau), math.exp(-acts / tau)
    first = acts - tau * (1.0 - left)
    second = 1.0 - tau * (1.0 - pole) * left
    b = np.array([first, second - (1.0 + pole) * first, 1.0 - pole - second + pole * first])
    return LinearPart(np.array([-pole]), b, whole, window_s)


def later(linear: LinearPart, delay_s: float, window_s: float) -> LinearPart:
    """Return a linear part behind a further delay.

    Exact for a first-order lag; of other dynamics, a part of a window mixes two neighbouring
    values.

    Parameters
    ----------
    linear
        The linear part.
    delay_s
        The delay, 0 or more.
    window_s
        Duration of a window.
    """
    if delay_s <= 0.0:
        return linear
    known = lag_and_delay_s(linear, window_s)
    if known is not None:
        late = first_order(known[0], known[1] + delay_s, window_s)
        return replace(late, slip_limit_rad_s=linear.slip_limit_rad_s)
    whole = int(delay_s / window_s)
    part = delay_s / window_s - whole
    b = np.convolve(linear.b, [1.0 - part, part])
    return replace(linear, b=b, dead_time_windows=linear.dead_time_windows + whole)


def _padded(linear: LinearPart, n: int) -> Array:
    """Numerator with its delay, over n windows."""
    padded = np.zeros(n)
    padded[linear.dead_time_windows :][: linear.b.size] = linear.b
    return padded
