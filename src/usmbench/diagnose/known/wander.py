"""What differs from run to run though nothing is wrong: gain, lag, friction, warm-up, habits."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.wander_shares import LEAST, Shares

Array = NDArray[np.float64]

# Shares by which a habit may be stronger: where the runs do not show it, and the least they show.
_STRONGER, _AS_STRONG = 0.1, 0.02
_BEST_GAIN = 2e-4  # no bench repeats better than that
_WARMS_ALIKE = 0.1  # of the least that one run cannot show
_RESONANCE = 3e-6  # by which a fifth of a kelvin moves it: no bench starts warmer by less

WARMS = ("warms_gain", "warms_held_back_rad_s", "warms_wider", "warms_shift")
"""What warming changes, with a column for each thermal time constant."""
COLUMNS = (
    "gain",
    "gain_tilt",
    "late_s",
    "resonance",
    "stuck_rad_s",
    "wider",
    "one_sided",
    "one_sided_ends",
    "held_back_rad_s",
    *WARMS,
    "habit_share",
)
"""What differs, in the order of the columns of `departures`."""


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
    one_sided_ends
        Of the same, less and less from ±90° in, and nothing at the edges: with the last one, where
        the edges move and the curve ends where it did.
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
    one_sided_ends: float
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
    def resonance(self) -> float:
        """Of the resonance as a run begins, as a share, on any bench."""
        return _RESONANCE

    @property
    def deviations(self) -> Array:
        """In the order of `COLUMNS`, shape (W,)."""
        sizes = [size for _, several in self.by_kind() for size in several]
        return np.repeat(sizes, self._n_columns)

    @property
    def kinds(self) -> NDArray[np.int64]:
        """Which of the `deviations` are one and the same, as numbers from 0, shape (W,)."""
        times = self._n_columns
        return np.repeat(np.arange(len(times)), times)

    @property
    def _n_columns(self) -> list[int]:
        """How many columns each kind has."""
        return [
            self.n_constants if name in WARMS else 1
            for name, several in self.by_kind()
            for _ in several
        ]

    def by_kind(self) -> Iterator[tuple[str, tuple[float, ...]]]:
        """Yield what differs, and the deviation of each kind of it."""
        for name in COLUMNS:
            size = getattr(self, name)
            yield name, size if isinstance(size, tuple) else (size,)

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            name: list(size) if isinstance(size, tuple) else size
            for name, size in asdict(self).items()
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
        float(content.get("one_sided_ends", LEAST.one_sided_ends)),
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
        shares.one_sided_ends,
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
    sizes = iter(deviations[first].tolist())
    found: dict[str, Any] = {}
    for name, several in like.by_kind():
        own = tuple(islice(sizes, len(several)))
        found[name] = own if isinstance(getattr(like, name), tuple) else own[0]
    del found["resonance"]
    return replace(like, **found)
