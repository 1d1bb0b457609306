"""The drive's amplitude droops with load.

The power is taken as (v/v_top)², v_top being the highest speed that the model knows. What a lower
vibration does to the speed is read from the resonance curve where the model knows that; elsewhere
both things that it does, less speed and more friction, are fitted.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.resonance import AlongResonance, WithoutResonance, vibrating_less
from usmbench.model.effects.weaker_drive import (
    HELD_BACK,
    SLOWEST_SUPPLY_S,
    travelling,
    weaker,
)
from usmbench.model.lagged import lagged

_MEANING = "The drive voltages give way while the motor delivers power: fast is slower than it was."
_MEND = "Watch both amplitudes at full speed and at 0°; look at the supply, its cable and fuse."
_DROOP = Parameter(
    "droop_at_top",
    "1",
    0.0,
    0.0,
    0.9,
    0.01,
    what="share of the speed that is lost at the power of the highest speed",
)
_HELD = replace(
    HELD_BACK,
    what="speed that friction takes as well at that power, most near standstill",
)
_STORE = Parameter(
    "store_s",
    "s",
    0.1,
    0.005,
    SLOWEST_SUPPLY_S,
    0.05,
    scanned=True,
    what="time constant with which the supply follows its load",
)


class Droop(WithoutResonance):
    """The vibration falls with the power, and the speed with it."""

    name = "amplitude_droop"
    form = "at once"
    meaning = _MEANING
    mend = _MEND
    parameters: ClassVar[tuple[Parameter, ...]] = (_DROOP, _HELD)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        load = _load(signal, context, values)
        lost, held_rad_s = values["droop_at_top"] * load, values["held_back_rad_s"] * load
        return weaker(signal, context, lost, held_rad_s)


class DroopAlongResonance(AlongResonance):
    """The same at every frequency, along the resonance curve that the model knows."""

    name = "amplitude_droop"
    form = "at once, along the resonance"
    meaning = _MEANING
    mend = _MEND
    parameters: ClassVar[tuple[Parameter, ...]] = (_DROOP,)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        lost = values["droop_at_top"] * _load(signal, context, values)
        return vibrating_less(signal, context, lost)


class _WithStore(Effect):
    """The supply's store follows the load with a time constant."""

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return time constants from two windows to three hundred.

        Parameters
        ----------
        contexts
            All stretches.
        """
        tried_s = contexts[0].window_s * np.geomspace(2, 300, 8)
        return {"store_s": np.unique(np.clip(tried_s, _STORE.low, _STORE.high))}


class SlowDroop(_WithStore, Droop):
    """As `Droop`, behind a store."""

    form = "after a while"
    parameters = (_DROOP, _HELD, _STORE)


class SlowDroopAlongResonance(_WithStore, DroopAlongResonance):
    """As `DroopAlongResonance`, behind a store."""

    form = "after a while, along the resonance"
    parameters = (_DROOP, _STORE)


def _load(signal: Array, context: Context, values: Values) -> Array:
    """Power that the supply delivers or, where it has a store, delivered of late; 1 at the top."""
    load = travelling(signal, context)
    if "store_s" not in values:
        return load
    return lagged(load, np.exp(-context.window_s / values["store_s"]), load[0])


FORMS = (Droop(), SlowDroop(), DroopAlongResonance(), SlowDroopAlongResonance())
