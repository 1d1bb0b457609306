"""What differs from run to run though nothing is wrong: gain, lag, friction, warm-up, habits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.shapes import (
    detuned_rad_s,
    held_back,
    later_rad_s_per_s,
    shown,
    speed_share,
)
from usmbench.model.extended import Applied, extended_run
from usmbench.model.linear import free_run

Array = NDArray[np.float64]

# The gain, by how much more at one end of speeds, frequencies and torques, the lag in s, and the
# shares of the highest speed that friction takes and that a rotor loses that sticks longer; gain,
# friction and resonance again, by what they change otherwise as the motor warms.
LEAST = (3e-4, 5e-5, 3e-6, 2e-4, 2e-4, 1e-3, 1e-3, 2e-5)  # repeatability that one run cannot show
ANY = (0.05, 0.01, 1e-4, 0.02, 0.02, 0.01, 0.01, 2e-4)  # while the wander is learnt
# Shares by which a habit may be stronger: where the runs do not show it, and the least they show.
_STRONGER, _AS_STRONG = 0.1, 0.02
_BEST_GAIN = 2e-4  # no bench repeats better than that
_WARMS_ALIKE = 0.1  # of the least that one run cannot show
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
    warms_gain, warms_held_back_rad_s, warms_shift
        Of what warming changes otherwise than is known, at each of the thermal time constants: the
        gain, as a share; the speed that friction takes, where nothing is known of the resonance;
        the resonance, as a share. A run starts at another temperature, and no two plans heat a
        motor alike.
    habit_share
        Of how much stronger a run shows what healthy ones show anyhow, as a share.
    n_constants
        Number of thermal time constants, from the shortest on.
    """

    gain: float
    gain_tilt: tuple[float, ...]
    late_s: float
    stuck_rad_s: float
    held_back_rad_s: tuple[float, ...]
    warms_gain: float
    warms_held_back_rad_s: float
    warms_shift: float
    habit_share: float
    n_constants: int

    @property
    def deviations(self) -> Array:
        """In the order of the columns of `departures`, the resonance's among them, shape (W,)."""
        shares = (self.gain, *self.gain_tilt)
        rest = (self.late_s, _RESONANCE, self.stuck_rad_s, *self.held_back_rad_s)
        warms = (self.warms_gain, self.warms_held_back_rad_s, self.warms_shift)
        return np.array([*shares, *rest, *np.repeat(warms, self.n_constants), self.habit_share])

    @property
    def kinds(self) -> NDArray[np.int64]:
        """Which of the `deviations` are one and the same, as numbers from 0, shape (W,)."""
        apart = 4 + len(self.gain_tilt) + len(self.held_back_rad_s)
        times = np.r_[np.ones(apart, dtype=np.int64), np.full(3, self.n_constants), 1]
        return np.repeat(np.arange(times.size), times)

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "gain": self.gain,
            "gain_tilt": list(self.gain_tilt),
            "late_s": self.late_s,
            "stuck_rad_s": self.stuck_rad_s,
            "held_back_rad_s": list(self.held_back_rad_s),
            "warms_gain": self.warms_gain,
            "warms_held_back_rad_s": self.warms_held_back_rad_s,
            "warms_shift": self.warms_shift,
            "habit_share": self.habit_share,
            "n_constants": self.n_constants,
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
        tuple(float(tilt) for tilt in content["gain_tilt"]),
        float(content["late_s"]),
        float(content["stuck_rad_s"]),
        tuple(float(held) for held in content["held_back_rad_s"]),
        float(content["warms_gain"]),
        float(content["warms_held_back_rad_s"]),
        float(content["warms_shift"]),
        float(content["habit_share"]),
        int(content["n_constants"]),
    )


def wander_of_shares(shares: tuple[float, ...], features: Features) -> Wander:
    """Return a wander that holds friction back alike at every operating point.

    Parameters
    ----------
    shares
        `LEAST` where nothing shows the wander, `ANY` to start from where it is learnt.
    features
        The model's shapes.
    """
    top_rad_s = features.top_rad_s
    gain, tilt, late_s, held, stuck, warms_gain, warms_held, warms_shift = shares
    return Wander(
        gain,
        (tilt,) * (1 + features.n_places),
        late_s,
        stuck * top_rad_s,
        (held * top_rad_s,) * features.n_points,
        warms_gain,
        warms_held * top_rad_s,
        warms_shift,
        _STRONGER,
        features.n_constants,
    )


def departures(stretch: Stretch, habits: Sequence[Applied], n_constants: int) -> Array:
    """Return the change of speed with each thing that wanders, in columns of shape (N, W).

    The crests may be faster or slower, by a share of the speed. A jump may come later. Friction may
    hold the rotor back more or less: most near standstill, where the wave is a standing one, not at
    all at the highest speed, and at each operating point by another amount, since it is the
    vibration that frees the rotor. A gain that wanders shows the latter, too: the rotor follows the
    crests but for the slip, so that the gain is off by another share at the highest speed and at
    another frequency or torque. A rotor that sticks may come free at a larger phase. As the motor
    warms, gain, friction and resonance may change otherwise. And what healthy
    runs show anyhow may be stronger.

    Parameters
    ----------
    stretch
        The stretch.
    habits
        What healthy runs show anyhow.
    n_constants
        Number of thermal time constants, from the shortest on.
    """
    share = speed_share(stretch)
    against = np.column_stack(stretch.points) * held_back(stretch)[:, None]
    stuck = -np.sign(share) * np.interp(np.abs(share), _STICKING, (0.0, 1.0, 0.0))
    linear, settled_rad_s = stretch.context.linear, stretch.settled_rad_s
    gain = stretch.simulated_rad_s
    if linear.slip_limit_rad_s is not None:  # which does not grow with it
        limited_rad_s = free_run(linear, settled_rad_s, float(settled_rad_s[0]))
        gain = gain - (limited_rad_s - shown(stretch, settled_rad_s))
    fast = 2.0 * np.minimum(np.abs(share), 1.0) - 1.0
    tilted = [gain * place for place in (fast, *stretch.places)]
    late, detuned = later_rad_s_per_s(stretch), detuned_rad_s(stretch)
    starts, habit = (shown(stretch, stuck), shown(stretch, against)), _stronger(stretch, habits)
    steady = stretch.warmth[0, :n_constants]
    # Where it is known, the resonance's move takes friction along.
    held = starts[1].sum(axis=1) * (stretch.context.detuning_rad_s is None)
    warms = [change * warmed for change in (gain, held, detuned) for warmed in steady]
    return np.column_stack((gain, *tilted, late, detuned, *starts, *warms, habit))


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
    return replace(
        least,
        gain=_BEST_GAIN,
        warms_gain=_WARMS_ALIKE * least.warms_gain,
        warms_held_back_rad_s=_WARMS_ALIKE * least.warms_held_back_rad_s,
        warms_shift=_WARMS_ALIKE * least.warms_shift,
        habit_share=_AS_STRONG,
    )


def wander_of_deviations(deviations: Array, like: Wander) -> Wander:
    """Return the wander with given `Wander.deviations`.

    Parameters
    ----------
    deviations
        As `Wander.deviations` returns them, shape (W,).
    like
        A wander with as many of each.
    """
    first = np.unique(like.kinds, return_index=True)[1]
    ends = 1 + len(like.gain_tilt)
    gain, *gain_tilt = (float(d) for d in deviations[first[:ends]])
    late_s, _, stuck_rad_s, *held_back, warms_gain, warms_held, warms_shift, habit = (
        float(d) for d in deviations[first[ends:]]
    )
    return Wander(
        gain,
        tuple(gain_tilt),
        late_s,
        stuck_rad_s,
        tuple(held_back),
        warms_gain,
        warms_held,
        warms_shift,
        habit,
        like.n_constants,
    )
