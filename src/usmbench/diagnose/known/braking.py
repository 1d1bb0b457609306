"""What a motor that brakes at another rate than it runs up leaves of a model with one lag."""

import math

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.effects.first_order import Lag, lag_of
from usmbench.model.linear import delayed

Array = NDArray[np.float64]

_TIME_CONSTANTS = 20.0  # after which a response is over


def braking_slower(stretch: Stretch) -> Array:
    """Return the change of speed for each share by which a motor takes longer to slow down, (N,).

    Friction helps a motor to brake, and is in its way as it runs up. On a reversal only the part
    to standstill is longer, what follows is later. Exact where the speed has settled before the
    next step; a limit of the torque is left aside.

    Parameters
    ----------
    stretch
        The stretch. Of dynamics that are no first-order lag nothing is said.
    """
    context, after = stretch.context, stretch.settled_rad_s
    lag, changed = lag_of(context.linear, context.window_s), np.zeros(context.n)
    if lag is None:
        return changed
    before = delayed(after, 1, after[0])
    turned = before * after < 0.0
    braked = np.where(turned | (np.abs(after) < np.abs(before)), after - before, 0.0)
    run_up = np.where(turned, after, 0.0)
    ratio = np.abs(before) / np.where(turned, np.abs(after), 1.0)
    stops_s = lag.tau_s * np.log1p(ratio * turned)
    lasts_s = lag.delay_s + _TIME_CONSTANTS * lag.tau_s
    for k in range(min(math.ceil(lasts_s / context.window_s) + 1, context.n)):
        since_s, rows = k * context.window_s - lag.delay_s, slice(0, context.n - k)
        changed[k:] += braked[rows] * _slower(lag, since_s, context.window_s)
        changed[k:] -= run_up[rows] * _slower(lag, since_s - stops_s[rows], context.window_s)
    return changed


def _slower(lag: Lag, since_s: Array | float, window_s: float) -> Array:
    """Return what a share more of τ does to a step's response, in a window that begins so late."""
    begin, end = (np.maximum(s, 0.0) / lag.tau_s for s in (since_s, since_s + window_s))
    if lag.sampled:
        return np.asarray(-end * np.exp(-end))
    grown = (1.0 + end) * np.exp(-end) - (1.0 + begin) * np.exp(-begin)
    return np.asarray(lag.tau_s / window_s * grown)
