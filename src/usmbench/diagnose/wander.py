"""What differs from run to run though nothing is wrong: gain, lag, friction, resonance."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.shapes import detuned_rad_s, highest_rad_s, later_rad_s_per_s, shown
from usmbench.diagnose.stretches import Stretch

Array = NDArray[np.float64]

# The gain's share, the lag's time in s, and the share of the highest speed that friction takes.
LEAST = (3e-4, 3e-6, 2e-4)  # repeatability that one run cannot show
ANY = (0.05, 1e-4, 0.02)  # any run may be off by this while the wander is learnt
_BEST_GAIN = 2e-4  # no bench repeats better than that
_RESONANCE = 3e-6  # by which a fifth of a kelvin moves it: no bench starts warmer by less
_FEWEST = 0.5  # degrees of freedom that an estimate needs
_STANDING = 0.01  # of the highest speed: in the dead zone a fitted curve is not exactly 0


@dataclass(frozen=True, slots=True)
class Wander:
    """Standard deviations from run to run.

    Parameters
    ----------
    gain
        Of the gain, as a share.
    late_s
        Of the time by which the speed follows a jump: friction brakes it more or less, and the
        commands meet the windows sooner or later.
    held_back_rad_s
        Of the speed that friction takes near standstill, at each operating point: the edges of the
        dead zone move with it.
    """

    gain: float
    late_s: float
    held_back_rad_s: tuple[float, ...]

    @property
    def deviations(self) -> Array:
        """In the order of the columns of `departures`, the resonance's among them, shape (W,)."""
        return np.array([self.gain, self.late_s, _RESONANCE, *self.held_back_rad_s])

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "gain": self.gain,
            "late_s": self.late_s,
            "held_back_rad_s": list(self.held_back_rad_s),
        }


def wander_from_mapping(content: Mapping[str, Any]) -> Wander:
    """Return the wander that a model file keeps.

    Parameters
    ----------
    content
        As `Wander.to_mapping` returns it.

    Raises
    ------
    KeyError, TypeError, ValueError
        A key is missing, or what it holds is no number.
    """
    return Wander(
        float(content["gain"]),
        float(content["late_s"]),
        tuple(float(held) for held in content["held_back_rad_s"]),
    )


def wander_of_shares(shares: tuple[float, float, float], top_rad_s: float, n_points: int) -> Wander:
    """Return a wander that holds friction back alike at every operating point.

    Parameters
    ----------
    shares
        `LEAST` where nothing shows the wander, `ANY` to start from where it is learnt.
    top_rad_s
        Highest speed of the model.
    n_points
        Number of its operating points.
    """
    gain, late_s, held_back = shares
    return Wander(gain, late_s, (held_back * top_rad_s,) * n_points)


def departures(stretch: Stretch) -> Array:
    """Return the change of speed with each thing that wanders, in columns of shape (N, W).

    The crests may be faster or slower, by a share of the speed. A jump may come later. Friction may
    hold the rotor back more or less: most near standstill, where the wave is a standing one, not at
    all at the highest speed, and at each operating point by another amount, since it is the
    vibration that frees the rotor. A gain that wanders shows the latter, too: the rotor follows the
    crests but for the slip.

    Parameters
    ----------
    stretch
        The stretch.
    """
    share = stretch.settled_rad_s / np.maximum(highest_rad_s(stretch), 1e-12)
    against = -np.clip(share / _STANDING, -1.0, 1.0) * (1.0 - np.minimum(share**2, 1.0))
    held_back = shown(stretch, np.column_stack(stretch.points) * against[:, None])
    gain = stretch.simulated_rad_s
    if stretch.context.linear.slip_limit_rad_s is not None:
        gain = shown(stretch, stretch.settled_rad_s)  # a torque limit does not grow with it
    late = later_rad_s_per_s(stretch)
    return np.column_stack((gain, late, detuned_rad_s(stretch), held_back))


def measured_wander(before: Wander, least: Wander, runs: Array, variance: Array) -> Wander:
    """Estimate the wander from each run's own departures.

    A run that hardly shows a departure leaves it where it was beforehand, and says nothing of how
    far it wanders: it counts by the share of the variance that it takes away (MacKay 1992,
    doi:10.1162/neco.1992.4.3.415).

    Parameters
    ----------
    before
        The wander that the departures were estimated with.
    least
        What stands in where the runs do not show it.
    runs, variance
        Departures and their variance, in units of the wander before, shape (R, W).
    """
    free = np.sum(1.0 - variance, axis=0) - 1.0  # the mean belongs to the model
    shown = free > _FEWEST
    free = np.where(shown, free, 1.0)
    # A standard deviation of few values is itself uncertain: err on the side of more wander.
    inflation = 1.0 + 1.0 / np.sqrt(2.0 * free)
    found = before.deviations * np.sqrt(np.sum(runs**2, axis=0) / free) * inflation
    gain, late_s, _, *held_back = np.where(shown, found, least.deviations)
    held_back_rad_s = np.maximum(held_back, least.held_back_rad_s).tolist()
    return Wander(
        max(float(gain), _BEST_GAIN), max(float(late_s), least.late_s), tuple(held_back_rad_s)
    )
