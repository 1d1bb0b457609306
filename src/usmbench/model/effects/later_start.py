"""Where a rotor starts: dead zones that are wider by some degrees."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context, highest_settled_rad_s
from usmbench.model.effects.parameter import Parameter

STANDING = 0.01
"""Share of the highest settled speed below which the rotor stands: a fitted curve is not exactly 0.

A diagnosis takes the edges of the dead zone by the same.
"""
_MANY_STARTS, _APART = 100, 1.1  # of more, those whose widths are that much larger than the last
_TURN_DEG = 360.0  # more than any phase
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
        """Return a width for every set of starts that it may put off; fewer where these are many.

        Parameters
        ----------
        contexts
            All stretches.
        """
        # Where few starts tell, all may be right between two widths near each other.
        ends = np.unique(np.concatenate([_at_starts_deg(c) for c in contexts]))
        ends = ends[ends > 0.0]
        widths_deg = 0.5 * (ends + np.r_[0.0, ends][:-1])
        widths_deg = widths_deg[widths_deg <= self.parameters[0].high]
        if not widths_deg.size:
            return {"start_later_deg": np.geomspace(0.02, 40.0, 30)}
        if ends.size > _MANY_STARTS:
            steps = np.floor(np.log(widths_deg) / np.log(_APART))
            widths_deg = widths_deg[np.unique(steps, return_index=True)[1]]
        return {"start_later_deg": widths_deg}


@dataclass(frozen=True)
class EdgesFartherOut(LaterStart):
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


def _at_starts_deg(context: Context) -> Array:
    """By how many degrees phases at which a later rotor may start lie beyond the dead zone, (K,).

    Those are farther out than all since the rotor last stood. The edge is found by halving: the
    curve may be of any kind, and dip below 0 before a jump.
    """
    settled_rad_s, least_rad_s = context.settled_rad_s(context.phase_deg), standing_rad_s(context)
    size, way = np.abs(context.phase_deg), np.sign(context.phase_deg)
    forward = way * np.copysign(1.0, np.sum(context.phase_deg * settled_rad_s))
    runs = forward * settled_rad_s > least_rad_s
    inside, outside = np.zeros(context.n), size
    for _ in range(_HALVINGS):
        middle = 0.5 * (inside + outside)
        fast = forward * context.settled_rad_s(way * middle) > least_rad_s
        inside, outside = np.where(fast, inside, middle), np.where(fast, middle, outside)
    starts = runs & _farthest(context.phase_deg, ~runs)
    found: Array = (size - outside)[starts].round(_DIGITS)
    return found


def _farthest(phase_deg: Array, stands: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Rows at which a phase is farther out than on all since the rotor stood, or turned round."""
    way = np.sign(phase_deg)
    since = np.cumsum(stands | (way != np.r_[way[:1], way[:-1]]))
    reached = np.abs(phase_deg) + _TURN_DEG * since
    before = np.r_[-1.0, np.maximum.accumulate(reached)[:-1]]
    farthest: NDArray[np.bool_] = reached > before
    return farthest


def standing_rad_s(context: Context, share: float = STANDING) -> float:
    """Return the settled speed below which the rotor counts as standing.

    Parameters
    ----------
    context
        The stretch.
    share
        Of the highest settled speed that it commands.
    """
    return share * highest_settled_rad_s([context])


WIDER = tuple(EdgesFartherOut(sides) for sides in ((-1.0, 1.0), (1.0,), (-1.0,)))
