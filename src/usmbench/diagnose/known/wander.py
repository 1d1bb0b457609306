"""What differs from run to run though nothing is wrong: gain, lag, friction, warm-up, habits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.shapes import (
    detuned_rad_s,
    later_rad_s_per_s,
    shown,
    speed_share,
    turning,
)
from usmbench.model.extended import Applied, extended_run
from usmbench.model.linear import free_run

Array = NDArray[np.float64]

# The gain, by how much more at one end of speeds, frequencies and torques, the lag in s, and the
# shares of the highest speed that friction takes and that a rotor loses that sticks longer.
LEAST = (3e-4, 5e-5, 3e-6, 2e-4, 2e-4)  # repeatability that one run cannot show
ANY = (0.05, 0.01, 1e-4, 0.02, 0.02)  # any run may be off by this while the wander is learnt
# Shares by which a run may warm otherwise than is known, since it starts at another temperature,
# and by which a habit may be stronger: where the runs do not show it, and the least that they show.
_WARMS, _WARMS_ALIKE = 0.25, 0.02  # not every plan is among them
_STRONGER, _AS_STRONG = 0.1, 0.02
_BEST_GAIN = 2e-4  # no bench repeats better than that
_RESONANCE = 3e-6  # by which a fifth of a kelvin moves it: no bench starts warmer by less
_STICKING = (0.0, 0.02, 0.05)  # shares of the highest speed: from, most, to
_STEP = 0.1  # of a habit's size, for its derivative


@dataclass(frozen=True, slots=True)
class Wander:
    """Standard deviations from run to run.

    Parameters
    ----------
    gain
        Of the gain, as a share.
    gain_tilt
        Of how much further it is off at the highest speed, and at one end of the frequencies and of
        the torques, than in their middle: the slip does not grow with it, and is another share of
        the speed there.
    late_s
        Of the time by which the speed follows a jump: friction brakes it more or less, and the
        commands meet the windows sooner or later.
    stuck_rad_s
        Of the speed lost where the dead zone ends: a rotor that sticks starts with a jump, on one
        day at a smaller phase than on another.
    held_back_rad_s
        Of the speed that friction takes near standstill, at each operating point: the edges of the
        dead zone move with it.
    warms
        Of what a run warms more or less than is known, and sooner or later, as shares.
    habit_share
        Of how much stronger a run shows what healthy ones show anyhow, as a share.
    """

    gain: float
    gain_tilt: tuple[float, ...]
    late_s: float
    stuck_rad_s: float
    held_back_rad_s: tuple[float, ...]
    warms: tuple[float, float]
    habit_share: float

    @property
    def deviations(self) -> Array:
        """In the order of the columns of `departures`, the resonance's among them, shape (W,)."""
        shares = (self.gain, *self.gain_tilt)
        rest = (self.late_s, _RESONANCE, self.stuck_rad_s, *self.held_back_rad_s)
        return np.array([*shares, *rest, *self.warms, self.habit_share])

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "gain": self.gain,
            "gain_tilt": list(self.gain_tilt),
            "late_s": self.late_s,
            "stuck_rad_s": self.stuck_rad_s,
            "held_back_rad_s": list(self.held_back_rad_s),
            "warms": list(self.warms),
            "habit_share": self.habit_share,
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
    more, later = content["warms"]
    return Wander(
        float(content["gain"]),
        tuple(float(tilt) for tilt in content["gain_tilt"]),
        float(content["late_s"]),
        float(content["stuck_rad_s"]),
        tuple(float(held) for held in content["held_back_rad_s"]),
        (float(more), float(later)),
        float(content["habit_share"]),
    )


def wander_of_shares(
    shares: tuple[float, ...], top_rad_s: float, n_points: int, n_places: int
) -> Wander:
    """Return a wander that holds friction back alike at every operating point.

    Parameters
    ----------
    shares
        `LEAST` where nothing shows the wander, `ANY` to start from where it is learnt.
    top_rad_s
        Highest speed of the model.
    n_points
        Number of its operating points.
    n_places
        Whether these differ in frequency, in torque (1) or in both (2).
    """
    gain, tilt, late_s, held_back, stuck = shares
    return Wander(
        gain,
        (tilt,) * (1 + n_places),
        late_s,
        stuck * top_rad_s,
        (held_back * top_rad_s,) * n_points,
        (_WARMS, _WARMS),
        _STRONGER,
    )


def departures(stretch: Stretch, warms_rad_s: Array, habits: Sequence[Applied]) -> Array:
    """Return the change of speed with each thing that wanders, in columns of shape (N, W).

    The crests may be faster or slower, by a share of the speed. A jump may come later. Friction may
    hold the rotor back more or less: most near standstill, where the wave is a standing one, not at
    all at the highest speed, and at each operating point by another amount, since it is the
    vibration that frees the rotor. A gain that wanders shows the latter, too: the rotor follows the
    crests but for the slip, so that the gain is off by another share at the highest speed and at
    another frequency or torque. A rotor that sticks may come free at a larger phase. The motor may
    warm more, or later. And what healthy runs show anyhow may be stronger.

    Parameters
    ----------
    stretch
        The stretch.
    warms_rad_s
        What it is known to change as it warms, and the same sooner or later, shape (N, 2).
    habits
        What healthy runs show anyhow.
    """
    share = speed_share(stretch)
    against = -np.sign(share) * turning(stretch) * (1.0 - np.minimum(share**2, 1.0))
    held_back = shown(stretch, np.column_stack(stretch.points) * against[:, None])
    stuck = -np.sign(share) * np.interp(np.abs(share), _STICKING, (0.0, 1.0, 0.0))
    linear, settled_rad_s = stretch.context.linear, stretch.settled_rad_s
    gain = stretch.simulated_rad_s
    if linear.slip_limit_rad_s is not None:  # which does not grow with it
        limited_rad_s = free_run(linear, settled_rad_s, float(settled_rad_s[0]))
        gain = gain - (limited_rad_s - shown(stretch, settled_rad_s))
    fast = 2.0 * np.minimum(np.abs(share), 1.0) - 1.0
    tilted = [gain * place for place in (fast, *stretch.places)]
    late, detuned = later_rad_s_per_s(stretch), detuned_rad_s(stretch)
    starts, habit = (shown(stretch, stuck), held_back), _stronger(stretch, habits)
    return np.column_stack((gain, *tilted, late, detuned, *starts, warms_rad_s, habit))


def _stronger(stretch: Stretch, habits: Sequence[Applied]) -> Array:
    """Return the change of speed for each share by which habits are stronger, shape (N,)."""
    if not habits:
        return np.zeros(stretch.context.n)
    more = [replace(h, values={**h.values, **_further(h)}) for h in habits]
    usual, stronger = (extended_run(e, stretch.context).speed_rad_s for e in (habits, more))
    return (stronger - usual) / _STEP


def _further(habit: Applied) -> dict[str, float]:
    """Sizes of a habit that is a little stronger."""
    sized = (p for p in habit.effect.parameters if not p.scanned)
    return {p.name: p.null + (1.0 + _STEP) * (habit.values[p.name] - p.null) for p in sized}


def lowest_shown(least: Wander) -> Wander:
    """Return the least that runs show that repeat as well as any.

    Parameters
    ----------
    least
        What stands in where they do not show it.
    """
    warms = (_WARMS_ALIKE, _WARMS_ALIKE)
    return replace(least, gain=_BEST_GAIN, warms=warms, habit_share=_AS_STRONG)


def wander_of_deviations(deviations: Array, n_tilts: int) -> Wander:
    """Return the wander with given `Wander.deviations`.

    Parameters
    ----------
    deviations
        As `Wander.deviations` returns them, shape (W,).
    n_tilts
        How many of them are tilts of the gain.
    """
    ends = 1 + n_tilts
    gain, *gain_tilt = (float(d) for d in deviations[:ends])
    late_s, _, stuck_rad_s, *held_back, more, later, habit = (float(d) for d in deviations[ends:])
    return Wander(
        gain, tuple(gain_tilt), late_s, stuck_rad_s, tuple(held_back), (more, later), habit
    )
