"""Speed changes as the motor warms."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values, longest_s

_MEANING = "The speed changes over the run as the motor warms and its resonance moves."
_MEND = "Warm up for longer, log the stator's temperature, and let the frequency follow it."
_DRIFT = Parameter("final_drift", "1", 0.0, -8.0, 8.0, 0.01)
_WARM_UP = Parameter("warm_up_s", "s", 30.0, 0.2, 3000.0, 5.0, scanned=True)


class ThermalDrift(Effect):
    """v′ = v (1 + d (1 − exp(−t/τ))): the resonance moves away under a fixed drive frequency.

    The first-order warm-up of a lumped heat capacity; for τ far beyond the run it is a straight
    line in time.
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
        warmed = -np.expm1(-context.t_s / values["warm_up_s"])
        return signal * np.maximum(1.0 + values["final_drift"] * warmed, 0.0)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return time constants from a thirtieth of the run to three runs.

        Parameters
        ----------
        contexts
            All stretches.
        """
        run_s = longest_s(contexts)
        return {"warm_up_s": np.clip(run_s * np.geomspace(0.03, 3.0, 9), 0.2, 3000.0)}


class DriftingDeadZone(ThermalDrift):
    """As `ThermalDrift`, and the dead zone widens with it: a lower vibration holds the rotor."""

    form = "speed and dead zone"
    parameters = (
        _DRIFT,
        Parameter("final_widening_deg", "deg", 0.0, -40.0, 80.0, 0.5),
        _WARM_UP,
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        warmed = -np.expm1(-context.t_s / values["warm_up_s"])
        phase_deg = context.phase_deg
        inward_deg = np.sign(phase_deg) * values["final_widening_deg"] * warmed
        change = context.settled_rad_s(phase_deg - inward_deg) - context.settled_rad_s(phase_deg)
        return super().apply(signal + change, context, values)


FORMS = (ThermalDrift(), DriftingDeadZone())
