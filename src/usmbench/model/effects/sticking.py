"""A standing rotor sticks: it starts later than it stops, both ways or one way only."""

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.later_start import WIDER, LaterStart, beyond, standing_rad_s

MEANING = "The motor starts later than it stops: the dead zone depends on where φ comes from."
MEND = "Look at preload and friction layer; run in the contact; sweep slowly through 0°."
_LATER = "how much farther than the curve says φ has to go before the rotor starts {}"
_AT_START = 1.5  # windows: up to then a run is at its beginning, and its rotor at rest


class Sticking(LaterStart):
    """A standing rotor needs h degrees more than the curve says; a running one follows the curve.

    Adhesion in the contact: once broken, the friction is the one that the curve was measured with.
    """

    name = "dead_zone_hysteresis"
    form = "sticking"
    meaning = MEANING
    mend = MEND
    sides: ClassVar[tuple[float, ...]] = (-1.0, 1.0)  # ways in which a start takes more
    at_reversals: ClassVar[bool] = True  # a rotor that is reversed passes through standstill

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed, 0 while the rotor sticks.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        later_deg = values["start_later_deg"]
        if later_deg <= 0.0:
            return signal
        way, least_rad_s = np.sign(signal), standing_rad_s(context)
        starts = beyond(signal, context, self.sides, later_deg)
        stops = np.abs(signal) <= least_rad_s
        if self.at_reversals:
            stops |= way != np.r_[way[:1], way[:-1]]
        runs = bool(context.t_s[0] > _AT_START * context.window_s)
        return np.where(_latched(starts, stops & ~starts, runs), signal, 0.0)

    @property
    def lookalikes(self) -> tuple[Effect, ...]:
        """Dead zones that are wider whatever φ comes from: the model's edges lie elsewhere."""
        return WIDER


class AtRest(Sticking):
    """Adhesion takes time to form: a rotor that is reversed does not stick on its way."""

    form = "sticking at rest"
    at_reversals = False


class Forwards(Sticking):
    """Only starts forwards take more."""

    form = "sticking forwards"
    sides = (1.0,)


class Backwards(Sticking):
    """Only starts backwards do."""

    form = "sticking backwards"
    sides = (-1.0,)


class EachWay(Sticking):
    """Starts forwards take other degrees more than starts backwards.

    Or they take the same, of a curve whose edges are off by other amounts.
    """

    form = "sticking, each way its own"
    apart = True
    parameters = (
        replace(Sticking.parameters[0], name="forwards_later_deg", what=_LATER.format("forwards")),
        replace(
            Sticking.parameters[0], name="backwards_later_deg", what=_LATER.format("backwards")
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed, 0 while the rotor sticks.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        ahead, back = (
            way.apply(signal, context, {"start_later_deg": values[p.name]})
            for way, p in zip((Forwards(), Backwards()), self.parameters, strict=True)
        )
        return np.where(signal > 0.0, ahead, back)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return the same widths for both ways.

        Parameters
        ----------
        contexts
            All stretches.
        """
        (widths_deg,) = super().grid(contexts).values()
        return {parameter.name: widths_deg for parameter in self.parameters}


def _latched(
    starts: NDArray[np.bool_], stops: NDArray[np.bool_], before: bool
) -> NDArray[np.bool_]:
    """State of a latch that the one sets and the other resets, as before until then."""
    rows = np.arange(starts.size)
    last = np.maximum.accumulate(np.where(starts | stops, rows, -1))
    state: NDArray[np.bool_] = np.where(last >= 0, starts[np.maximum(last, 0)], before)
    return state
