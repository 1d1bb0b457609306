"""What the rotor does on each row by the model: turns, runs out, starts or stops.

Where the noise is estimated, and what it is, hang on it.
"""

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.model.hammerstein import CREST_DEG

Array = NDArray[np.float64]

KINDS = 4
REVERSAL = 3  # of the kinds
# A smooth curve rounds the corner of the dead zone off (docs/decisions/0006): where it turns within
# a degree either way, this share of the turn counts as noise. Neither number is measured.
_CORNER_DEG, _DISTRUST = 1.0, 0.3
_STANDING = 0.02  # of the highest speed: less counts as a stop; nothing measured sets it
_BEYOND_DEG = 0.5  # how much farther out tells how near an edge a phase lies


def bend_rad_s(stretch: Stretch) -> Array:
    """Return how little the curve can be trusted where it bends sharply: where the motor starts.

    Parameters
    ----------
    stretch
        The stretch.
    """
    curve, phase_deg = stretch.context.settled_rad_s, stretch.context.phase_deg
    # Not over the crest, beyond which it comes back.
    short_deg = np.clip(phase_deg, _CORNER_DEG - CREST_DEG, CREST_DEG - _CORNER_DEG)
    phase_deg = np.where(np.abs(phase_deg) > CREST_DEG, phase_deg, short_deg)
    around = curve(phase_deg - _CORNER_DEG) + curve(phase_deg + _CORNER_DEG)
    # Of the curve alone: a habit that takes speed is no bend.
    bend: Array = _DISTRUST * np.abs(around - 2.0 * curve(phase_deg))
    return bend


def farther_out(stretch: Stretch) -> Array:
    """Return the speed half a degree farther from 0, as a share of the stretch's highest, (N,).

    Parameters
    ----------
    stretch
        The stretch.
    """
    context = stretch.context
    beyond_deg = context.phase_deg + np.copysign(_BEYOND_DEG, context.phase_deg)
    top_rad_s = float(np.max(np.abs(stretch.settled_rad_s), initial=0.0))
    share: Array = np.abs(context.settled_rad_s(beyond_deg)) / max(top_rad_s, 1e-12)
    return share


def stands_below_rad_s(stretch: Stretch) -> float:
    """Return the settled speed that a stretch has to exceed to count as turning.

    Parameters
    ----------
    stretch
        The stretch.
    """
    return _STANDING * float(np.max(np.abs(stretch.settled_rad_s), initial=0.0))


def turns(stretch: Stretch) -> Mask:
    """Return the rows at whose phases the rotor turns, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    """
    turning: Mask = np.abs(stretch.settled_rad_s) > stands_below_rad_s(stretch)
    return turning


def runs_out(stretch: Stretch) -> Array:
    """Return how much a rotor that is to stand turns still, from 0 to 1, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    """
    left_rad_s = np.abs(stretch.simulated_rad_s) - np.abs(stretch.settled_rad_s)
    share = np.clip(left_rad_s / max(stands_below_rad_s(stretch), 1e-12), 0.0, 1.0)
    return np.where(turns(stretch), 0.0, share)


def step_kind(stretch: Stretch) -> NDArray[np.int64]:
    """Return the kind of each row's last step: 0 runs on, 1 into a stop, 2 out of it, 3 through it.

    Parameters
    ----------
    stretch
        The stretch.
    """
    after = stretch.settled_rad_s
    before = after - stretch.step_rad_s
    least = stands_below_rad_s(stretch)
    stopped, stood = np.abs(after) <= least, np.abs(before) <= least
    return np.select([stopped, stood, before * after < 0.0], [1, 2, 3], 0)
