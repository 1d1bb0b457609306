"""Where a rotor starts: dead zones that are wider by some degrees."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context, highest_settled_rad_s
from usmbench.model.effects.parameter import Parameter

_STANDING = 0.01  # share of the highest settled speed of the stretch below which the rotor stands
_MANY_PHASES = 100
_HALVINGS, _DIGITS = 14, 2  # enough for a hundredth of a degree


class LaterStart(Effect):
    """A rotor that needs h degrees more than the curve says; scanned, since it starts or not."""

    stage = "settled"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            "start_later_deg",
            "deg",
            0.0,
            0.0,
            60.0,
            1.0,
            scanned=True,
            what="how much farther than the curve says φ has to go before the rotor starts",
        ),
    )

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return a width for every set of starts that it may put off; a few where these are many.

        Parameters
        ----------
        contexts
            All stretches.
        """
        # In a staircase of wide steps all starts may be right between two widths near each other.
        few = np.unique(np.concatenate([c.phase_deg for c in contexts])).size <= _MANY_PHASES
        ends = np.unique(np.concatenate([_into_run_deg(c) if few else [] for c in contexts]))
        ends = ends[ends > 0.0]
        if not ends.size:
            return {"start_later_deg": np.geomspace(0.02, 40.0, 30)}
        return {"start_later_deg": 0.5 * (ends + np.r_[0.0, ends[:-1]])}


@dataclass(frozen=True)
class WiderDeadZone(LaterStart):
    """The rotor stands h degrees farther, outward and inward bound: no cause, the curve is off.

    Parameters
    ----------
    sides
        Ways, 1 and −1, in which it does.
    """

    sides: tuple[float, ...]
    name = "wider_dead_zone"
    meaning = "The dead zone is wider than the model's."
    mend = "Identify the model on phases close to both edges of the dead zone."

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed, 0 in the wider zone.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        later_deg = values["start_later_deg"]
        starts = beyond(signal, context, self.sides, later_deg)
        return np.where(starts | (later_deg <= 0.0), signal, 0.0)


def beyond(
    signal: Array, context: Context, sides: Sequence[float], later_deg: float
) -> NDArray[np.bool_]:
    """Return where the rotor runs, and ran so many degrees nearer to 0, too, shape (N,).

    Parameters
    ----------
    signal
        Settled speed, shape (N,).
    context
        The stretch.
    sides
        Ways, 1 and −1, in which it has to run there, too.
    later_deg
        By how many degrees nearer.
    """
    way, least_rad_s = np.sign(signal), standing_rad_s(context)
    # Of two ways to wire a motor, one runs backwards at a positive phase.
    outward = way * np.copysign(1.0, np.sum(context.phase_deg * signal))
    nearer_deg = context.phase_deg - outward * np.where(np.isin(way, sides), later_deg, 0.0)
    # An identified curve is not quite 0 in the dead zone: beyond its middle, no rotor runs.
    outside = (way * context.settled_rad_s(nearer_deg) > least_rad_s) & (outward * nearer_deg > 0.0)
    runs: NDArray[np.bool_] = (np.abs(signal) > least_rad_s) & outside
    return runs


def _into_run_deg(context: Context) -> Array:
    """By how many degrees the phases at which the rotor runs lie beyond the dead zone, shape (K,).

    The edge is found by halving: the curve may be of any kind, and dip below 0 before a jump.
    """
    size, way = np.abs(context.phase_deg), np.sign(context.phase_deg)
    least_rad_s, settled_rad_s = standing_rad_s(context), context.settled_rad_s(context.phase_deg)
    forward = way * np.copysign(1.0, np.sum(context.phase_deg * settled_rad_s))
    runs = forward * settled_rad_s > least_rad_s
    inside, outside = np.zeros(context.n), size
    for _ in range(_HALVINGS):
        middle = 0.5 * (inside + outside)
        fast = forward * context.settled_rad_s(way * middle) > least_rad_s
        inside, outside = np.where(fast, inside, middle), np.where(fast, middle, outside)
    found: Array = (size - outside)[runs].round(_DIGITS)
    return found


def standing_rad_s(context: Context, share: float = _STANDING) -> float:
    """Return the settled speed below which the rotor counts as standing.

    Parameters
    ----------
    context
        The stretch.
    share
        Of the highest settled speed that it commands.
    """
    return share * highest_settled_rad_s([context])


WIDER = tuple(WiderDeadZone(sides) for sides in ((-1.0, 1.0), (1.0,), (-1.0,)))
