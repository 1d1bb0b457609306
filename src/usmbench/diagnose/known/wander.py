"""What differs from run to run though nothing is wrong: gain, lag, friction, warm-up, habits."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.known.features import Features

Array = NDArray[np.float64]

# Shares by which a habit may be stronger: where the runs do not show it, and the least they show.
_STRONGER, _AS_STRONG = 0.1, 0.02
_BEST_GAIN = 2e-4  # no bench repeats better than that
_WARMS_ALIKE = 0.1  # of the least that one run cannot show
_RESONANCE = 3e-6  # by which a fifth of a kelvin moves it: no bench starts warmer by less


class Shares(NamedTuple):
    """Standard deviations from run to run, alike at every operating point.

    Parameters
    ----------
    gain, tilt, wider, one_sided, warms_gain, warms_wider, warms_shift
        Shares, as in `Wander`.
    late_s
        In s.
    stuck, held, warms_held
        What are speeds in `Wander`, as shares of the highest.
    """

    gain: float
    tilt: float
    late_s: float
    stuck: float
    wider: float
    one_sided: float
    held: float
    warms_gain: float
    warms_held: float
    warms_wider: float
    warms_shift: float


LEAST = Shares(
    gain=3e-4,
    tilt=5e-5,
    late_s=3e-6,
    stuck=2e-4,
    wider=1e-3,
    one_sided=3e-4,
    held=2e-4,
    warms_gain=1e-3,
    warms_held=1e-3,
    warms_wider=1e-3,
    warms_shift=2e-5,
)
"""Repeatability that one run cannot show."""
ANY = Shares(
    gain=0.05,
    tilt=0.01,
    late_s=1e-4,
    stuck=0.02,
    wider=0.05,
    one_sided=0.01,
    held=0.02,
    warms_gain=0.01,
    warms_held=0.01,
    warms_wider=0.05,
    warms_shift=2e-4,
)
"""What it may be while it is learnt."""


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
    wider
        Of the width of the dead zone, as a share.
    one_sided
        Of how much more it widens on one side than on the other, as a share: nobody knows its ends
        well enough to say how far a share of each moves them.
    held_back_rad_s
        Of the speed that friction takes near standstill, at each operating point: the edges of the
        dead zone move with it.
    warms_gain, warms_held_back_rad_s, warms_wider, warms_shift
        Of what warming changes otherwise than is known, at each of the thermal time constants: the
        gain, as a share; the speed that friction takes, where nothing is known of the resonance;
        the dead zone, as a share of its width; the resonance, as a share. A run starts at another
        temperature, and no two plans heat a motor alike.
    habit_share
        Of how much stronger a run shows what healthy ones show anyhow, as a share.
    n_constants
        Number of thermal time constants, from the shortest on.
    """

    gain: float
    gain_tilt: tuple[float, ...]
    late_s: float
    stuck_rad_s: float
    wider: float
    one_sided: float
    held_back_rad_s: tuple[float, ...]
    warms_gain: float
    warms_held_back_rad_s: float
    warms_wider: float
    warms_shift: float
    habit_share: float
    n_constants: int

    @property
    def knows_warming(self) -> bool:
        """Whether runs have shown how the motor warms."""
        return self.warms_gain > 0.0

    @property
    def either_edge(self) -> float:
        """Of where the dead zone ends on one side, as a share."""
        return float(np.hypot(self.wider, self.one_sided))

    @property
    def deviations(self) -> Array:
        """In the order of the columns of `departures`, the resonance's among them, shape (W,)."""
        shares = (self.gain, *self.gain_tilt)
        dead_zone = (self.wider, self.one_sided)
        rest = (self.late_s, _RESONANCE, self.stuck_rad_s, *dead_zone, *self.held_back_rad_s)
        warms = (self.warms_gain, self.warms_held_back_rad_s, self.warms_wider, self.warms_shift)
        return np.array([*shares, *rest, *np.repeat(warms, self.n_constants), self.habit_share])

    @property
    def kinds(self) -> NDArray[np.int64]:
        """Which of the `deviations` are one and the same, as numbers from 0, shape (W,)."""
        apart = 6 + len(self.gain_tilt) + len(self.held_back_rad_s)
        times = np.r_[np.ones(apart, dtype=np.int64), np.full(4, self.n_constants), 1]
        return np.repeat(np.arange(times.size), times)

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "gain": self.gain,
            "gain_tilt": list(self.gain_tilt),
            "late_s": self.late_s,
            "stuck_rad_s": self.stuck_rad_s,
            "wider": self.wider,
            "one_sided": self.one_sided,
            "held_back_rad_s": list(self.held_back_rad_s),
            "warms_gain": self.warms_gain,
            "warms_held_back_rad_s": self.warms_held_back_rad_s,
            "warms_wider": self.warms_wider,
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
    """
    return Wander(
        float(content["gain"]),
        tuple(float(tilt) for tilt in content["gain_tilt"]),
        float(content["late_s"]),
        float(content["stuck_rad_s"]),
        float(content["wider"]),
        float(content.get("one_sided", LEAST.one_sided)),
        tuple(float(held) for held in content["held_back_rad_s"]),
        float(content["warms_gain"]),
        float(content["warms_held_back_rad_s"]),
        float(content["warms_wider"]),
        float(content["warms_shift"]),
        float(content["habit_share"]),
        int(content["n_constants"]),
    )


def wander_of_shares(shares: Shares, features: Features) -> Wander:
    """Return a wander that holds friction back alike at every operating point.

    Parameters
    ----------
    shares
        `LEAST` where nothing shows the wander, `ANY` to start from where it is learnt.
    features
        The model's shapes.
    """
    top_rad_s = features.top_rad_s
    return Wander(
        shares.gain,
        (shares.tilt,) * (1 + features.n_places),
        shares.late_s,
        shares.stuck * top_rad_s,
        shares.wider,
        shares.one_sided,
        (shares.held * top_rad_s,) * features.n_points,
        shares.warms_gain,
        shares.warms_held * top_rad_s,
        shares.warms_wider,
        shares.warms_shift,
        _STRONGER,
        features.n_constants,
    )


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
        warms_wider=_WARMS_ALIKE * least.warms_wider,
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
    late_s, _, stuck_rad_s, wider, one_sided, *held_back = (
        float(d) for d in deviations[first[ends:-5]]
    )
    warms_gain, warms_held, warms_wider, warms_shift, habit_share = (
        float(d) for d in deviations[first[-5:]]
    )
    return Wander(
        gain,
        tuple(gain_tilt),
        late_s,
        stuck_rad_s,
        wider,
        one_sided,
        tuple(held_back),
        warms_gain,
        warms_held,
        warms_wider,
        warms_shift,
        habit_share,
        like.n_constants,
    )
