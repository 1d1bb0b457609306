"""What the rotor does on each row by the model: turns on, runs out, starts or stops.

Where the noise is estimated, what it is, and which windows may stand alone, hang on it.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

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
_RUNNING = 0.1  # of the highest speed
_GENTLE = 0.1  # the same, a window: a command that glides
# Windows until the noise says how sure the speed of a rotor is that turns on, or starts and stops.
_SETTLING, _STARTING = 2, 3
_AROUND = 3  # windows: with the one before and the one after
_DIGITS, _WHOLE = 6, 0.02  # of a speed in rad/s; counts: how far from a whole one


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


def steady(stretch: Stretch) -> Mask:
    """Return the rows on which nothing but the counter can make a window stand alone.

    Parameters
    ----------
    stretch
        The stretch. A rotor that starts or stops does so at a moment of its own.
    """
    settled = np.abs(stretch.settled_rad_s)
    top_rad_s = float(np.max(settled, initial=0.0))
    gently = (np.abs(stretch.step_rad_s) < _GENTLE * top_rad_s) | (stretch.lag >= _SETTLING)
    on: Mask = stretch.use & (settled > _RUNNING * top_rad_s)
    calm: Mask = on & (gently & (step_kind(stretch) == 0) | (stretch.lag >= _STARTING))
    return calm


def runs_on(stretch: Stretch) -> Mask:
    """Return the rows around which the rotor turns on, however its speed changes, shape (N,).

    Parameters
    ----------
    stretch
        The stretch.
    """
    speed = stretch.simulated_rad_s
    least_rad_s = _RUNNING * float(np.max(np.abs(stretch.settled_rad_s), initial=0.0))
    forwards = minimum_filter1d(speed, _AROUND) > least_rad_s
    backwards = maximum_filter1d(speed, _AROUND) < -least_rad_s
    kept_on: Mask = stretch.use & (step_kind(stretch) == 0) & (forwards | backwards)
    return kept_on


def moved_rad_s(stretch: Stretch) -> Array:
    """Return how far a motor that comes a little sooner or later may be off in a window, (N,).

    By what the speed changes by around the window, and by a rotor that creeps or stands.

    Parameters
    ----------
    stretch
        The stretch.
    """
    speed = stretch.simulated_rad_s
    around = maximum_filter1d(speed, _AROUND) - minimum_filter1d(speed, _AROUND)
    top_rad_s = float(np.max(np.abs(stretch.settled_rad_s), initial=0.0))
    return np.asarray(np.maximum(around, _RUNNING * top_rad_s))


def whole_count_rad_s(stretch: Stretch) -> float:
    """Return the speed of one count a window where all speeds are whole counts, else next to 0.

    Parameters
    ----------
    stretch
        The stretch.
    """
    speeds = np.unique(np.round(np.abs(stretch.speed_rad_s), _DIGITS))
    known_rad_s = stretch.context.count_rad_s
    if not known_rad_s and speeds.size < 2:
        return 0.0
    count_rad_s = known_rad_s or float(np.min(np.diff(speeds)))
    off = speeds / count_rad_s
    return count_rad_s if np.all(np.abs(off - np.rint(off)) < _WHOLE) else 0.0
