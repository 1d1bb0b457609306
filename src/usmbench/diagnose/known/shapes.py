"""What a small change of the motor would do to the speed, row by row."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.dead_zone import edge_of_standstill_deg, highest_rad_s
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.effects.first_order import later
from usmbench.model.effects.later_start import STANDING
from usmbench.model.hammerstein import CREST_DEG, LinearPart
from usmbench.model.linear import free_run, from_rest

Array = NDArray[np.float64]

_NUDGE = 1e-4  # of the slip at which the torque gives out, and of a window
_TRACE = 1e-4  # of what a change begins with
_NEAR_DEG, _FAR_DEG = 0.25, 5.0  # over which a slope is taken


def felt(linear: LinearPart, off_rad_s: Array) -> Array:
    """Pass changes of the settled speed through the linear part, and drop what is left at last.

    Columns ought to be mostly zeros. A limit of the torque is left aside: its tangent takes a free
    run for each of them.

    Parameters
    ----------
    linear
        The linear part.
    off_rad_s
        The changes, shape (N, K).
    """
    felt = from_rest(linear.b, linear.a, linear.dead_time_windows, off_rad_s)
    return np.where(np.abs(felt) < _TRACE, 0.0, felt)


def shown(stretch: Stretch, settled_rad_s: Array) -> Array:
    """Return what the shaft shows of a small change of the settled speed, from rest.

    Parameters
    ----------
    stretch
        The stretch.
    settled_rad_s
        The change, shape (N,), or (N, K) for K of them at once.
    """
    linear = stretch.context.linear
    limit_rad_s = linear.slip_limit_rad_s
    if limit_rad_s is None:
        return from_rest(linear.b, linear.a, linear.dead_time_windows, settled_rad_s)
    moved: Array = np.apply_along_axis(partial(_limited, stretch, limit_rad_s), 0, settled_rad_s)
    return moved


def _limited(stretch: Stretch, limit_rad_s: float, change: Array) -> Array:
    """Tangent of the run with a torque limit along a change, shape (N,)."""
    linear, settled_rad_s = stretch.context.linear, stretch.settled_rad_s
    largest = float(np.max(np.abs(change)))
    if largest == 0.0:
        return change
    step, start_rad_s = _NUDGE * limit_rad_s / largest, float(settled_rad_s[0])
    moved = free_run(linear, settled_rad_s + step * change, start_rad_s)
    return (moved - free_run(linear, settled_rad_s, start_rad_s)) / step


def widening(stretch: Stretch, wider_deg: Array | float = 1.0) -> Array:
    """Return the change of speed where the dead zone widens on both sides, in rad/s, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    wider_deg
        By how much on the side that each row's phase is on, shape (N,), or on both.
    """
    context = stretch.context
    phase_deg, way = context.phase_deg, np.sign(context.phase_deg)
    # A curve is smoother than the straight lines between its nodes, but not where it starts.
    outside_deg = np.abs(phase_deg) - edge_of_standstill_deg(stretch)
    reach_deg = 0.5 * np.clip(outside_deg, _NEAR_DEG, _FAR_DEG)
    # Not over the crest, beyond which it comes back.
    short_deg = CREST_DEG - np.abs(phase_deg)
    outward_deg = np.where(short_deg >= 0.0, np.minimum(reach_deg, short_deg), reach_deg)
    inward, outward = (
        context.settled_rad_s(phase_deg + way * by_deg) for by_deg in (-reach_deg, outward_deg)
    )
    slope_rad_s_per_deg = (inward - outward) / (reach_deg + outward_deg)
    # Before the lag: in the window after a jump the rotor still turns as on the side it left.
    return shown(stretch, slope_rad_s_per_deg * wider_deg)


def widening_by_share(stretch: Stretch, share: Array | float = 1.0) -> Array:
    """Return the change of speed where each side of the dead zone widens by a share, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    share
        Of the width of the side that each row's phase is on, shape (N,), or of both.
    """
    return widening(stretch, edge_of_standstill_deg(stretch) * share)


def speed_share(stretch: Stretch) -> Array:
    """Return the settled speed as a share of the highest at each row's operating point, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    """
    share: Array = stretch.settled_rad_s / np.maximum(highest_rad_s(stretch), 1e-12)
    return share


def turning(stretch: Stretch) -> Array:
    """Return 0 where friction holds the rotor, and 1 where it turns, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    """
    turns: Array = np.minimum(np.abs(speed_share(stretch)) / STANDING, 1.0)
    return turns


def held_back(stretch: Stretch) -> Array:
    """Return the change of the settled speed where friction takes more of it, per unit, shape (N,).

    Most near standstill, where the wave is a standing one; none at the highest speed.

    Parameters
    ----------
    stretch
        The stretch.
    """
    share = speed_share(stretch)
    against: Array = -np.sign(share) * turning(stretch) * (1.0 - np.minimum(share**2, 1.0))
    return against


def detuned_rad_s(stretch: Stretch) -> Array:
    """Return the change of speed with the relative drive frequency, 0 where it is not known.

    A little of it starts no rotor that friction holds.

    Parameters
    ----------
    stretch
        The stretch.
    """
    context, detuning_rad_s = stretch.context, stretch.context.detuning_rad_s
    if detuning_rad_s is None:
        return np.zeros(context.n)
    return shown(stretch, turning(stretch) * detuning_rad_s(context.phase_deg))


def later_rad_s_per_s(stretch: Stretch) -> Array:
    """Return the change of speed for each second by which commands act later, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    """
    linear, window_s = stretch.context.linear, stretch.context.window_s
    little_s = _NUDGE * window_s
    start_rad_s = float(stretch.settled_rad_s[0])
    late, latest = (
        free_run(later(linear, k * little_s, window_s), stretch.settled_rad_s, start_rad_s)
        for k in (1.0, 2.0)
    )
    return (latest - late) / little_s
