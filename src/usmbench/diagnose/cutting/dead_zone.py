"""Where a model's motor stands: the ends of its dead zone at each row's operating point."""

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.effects.later_start import STANDING

Array = NDArray[np.float64]

_HALVINGS = 12  # of the range, to a fiftieth of a degree


def highest_rad_s(stretch: Stretch) -> Array:
    """Return the highest speed at each row's operating point, over the phases of the stretch.

    Parameters
    ----------
    stretch
        The stretch.
    """
    context = stretch.context
    top_deg = context.phase_deg[np.argmax(np.abs(stretch.settled_rad_s))]
    return np.abs(context.settled_rad_s(np.full(context.n, top_deg)))


def edge_of_standstill_deg(stretch: Stretch, stands: float = STANDING) -> Array:
    """Return where the dead zone ends on the side of each row's phase, as a size, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    stands
        Share of the highest speed below which the rotor stands.
    """
    context = stretch.context
    way, least_rad_s = np.sign(context.phase_deg), stands * highest_rad_s(stretch)
    inside_deg = np.zeros(context.n)
    step_deg = float(np.max(np.abs(context.phase_deg)))
    for _ in range(_HALVINGS):
        step_deg *= 0.5
        slow = np.abs(context.settled_rad_s(way * (inside_deg + step_deg))) < least_rad_s
        inside_deg = np.where(slow, inside_deg + step_deg, inside_deg)
    return inside_deg
