"""Speed changes as the motor warms."""

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context, longest_s
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.resonance import AlongResonance, WithoutResonance, detuned
from usmbench.model.effects.weaker_drive import SLOWEST_SUPPLY_S, weaker

_MEANING = "The speed changes over the run as the motor warms and its resonance moves."
_MEND = "Warm up for longer, log the stator's temperature, and let the frequency follow it."
_DRIFT = Parameter(
    "final_drift",
    "1",
    0.0,
    -1.0,
    1.0,
    0.01,
    what="share of the speed that is gained when all is warm; negative is lost",
)
# A drift that is over sooner is no warm-up: it would look like another gain.
_WARM_UP = Parameter(
    "warm_up_s",
    "s",
    30.0,
    SLOWEST_SUPPLY_S,
    3000.0,
    5.0,
    scanned=True,
    what="time constant of the warming",
)


class ThermalDrift(Effect):
    """v′ = v (1 + d (1 − exp(−t/τ))): the resonance moves away under a fixed drive frequency.

    The first-order warm-up of a lumped heat capacity; for τ far beyond the run it is a straight
    line in time. Where the drive is off it cools again.
    """

    name = "thermal_drift"
    form = "speed"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters: ClassVar[tuple[Parameter, ...]] = (_DRIFT, _WARM_UP)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal * np.maximum(1.0 + self._drift(signal, context, values), 0.0)

    def _drift(self, _signal: Array, context: Context, values: Values) -> Array:
        """Return the share of the speed that is gained, shape (N,)."""
        return values["final_drift"] * context.warmed(values["warm_up_s"])

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return time constants from a thirtieth of the run to three runs.

        Parameters
        ----------
        contexts
            All stretches.
        """
        run_s = longest_s(contexts)
        warm_up = self.parameters[-1]
        tried_s = np.clip(run_s * np.geomspace(0.03, 3.0, 9), warm_up.low, warm_up.high)
        return {"warm_up_s": np.unique(tried_s)}


class DriftByTurning(ThermalDrift):
    """v′ = v (1 + d (1 − exp(−t/τ)) + c w), w being |v| behind the same lag: heat of the contact.

    What slips in the contact warms the motor where it turns; where it stands it cools.
    """

    form = "speed, by turning"
    parameters = (
        _DRIFT,
        Parameter(
            "final_drift_by_turning_s_per_rad",
            "s/rad",
            0.0,
            -1.0,
            1.0,
            0.001,
            what="the same, for each rad/s at which it turns for long",
        ),
        _WARM_UP,
    )

    def _drift(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the share of the speed that is gained, shape (N,)."""
        turned_rad_s = context.behind(np.abs(signal), values["warm_up_s"])
        by_turning = values["final_drift_by_turning_s_per_rad"] * turned_rad_s
        return super()._drift(signal, context, values) + by_turning


class DriftingFriction(WithoutResonance, ThermalDrift):
    """As `ThermalDrift`, and friction grows with it: a lower vibration frees less of the rotor."""

    form = "speed and friction"
    parameters = (
        _DRIFT,
        Parameter(
            "final_held_back_rad_s",
            "rad/s",
            0.0,
            -30.0,
            30.0,
            0.05,
            what="speed that friction takes as well when all is warm, most near standstill",
        ),
        _WARM_UP,
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        warmed = context.warmed(values["warm_up_s"])
        lost, held_rad_s = -values["final_drift"], values["final_held_back_rad_s"]
        return weaker(signal, context, lost * warmed, held_rad_s * warmed)


class DriftingResonance(ThermalDrift, AlongResonance):
    """v′ = v − d (1 − exp(−t/τ)) f ∂v/∂f: the resonance moves, along the curve the model knows."""

    form = "along the resonance"
    parameters = (
        Parameter(
            "final_shift_ppm",
            "ppm",
            0.0,
            -20_000.0,
            20_000.0,
            10.0,
            what="how far up the resonance has moved when all is warm",
        ),
        # What is over sooner would look like another frequency.
        replace(_WARM_UP, low=5.0),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        warmed = context.warmed(values["warm_up_s"])
        return detuned(signal, context, -1e-6 * values["final_shift_ppm"] * warmed)


FORMS = (ThermalDrift(), DriftByTurning(), DriftingFriction(), DriftingResonance())
