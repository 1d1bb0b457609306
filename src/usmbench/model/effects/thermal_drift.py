"""Speed changes as the motor warms."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values, longest_s


class ThermalDrift(Effect):
    """v′ = v (1 + d (1 − exp(−t/τ))): the resonance moves away under a fixed drive frequency.

    The first-order warm-up of a lumped heat capacity; for τ far beyond the run it is a straight
    line in time.
    """

    name = "thermal_drift"
    meaning = "The speed changes over the run as the motor warms and its resonance moves."
    mend = "Warm up for longer, log the stator's temperature, and let the frequency follow it."
    stage = "settled"
    parameters = (
        Parameter("final_drift", "1", 0.0, -8.0, 8.0, 0.01),
        Parameter("warm_up_s", "s", 30.0, 0.2, 3000.0, 5.0, scanned=True),
    )

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


FORMS = (ThermalDrift(),)
