"""The drive's amplitude droops with load."""

from collections.abc import Sequence

import numpy as np
from scipy.signal import lfilter

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values

_MEANING = "The drive voltages give way while the motor delivers power: fast is slower than it was."
_MEND = "Watch both amplitudes at full speed and at 0°; look at the supply, its cable and fuse."


class Droop(Effect):
    """v′ = v (1 − d v²/v_top²): the amplitude falls with the power, and the speed with it."""

    name = "amplitude_droop"
    form = "at once"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (Parameter("droop_at_top", "1", 0.0, 0.0, 0.9, 0.01),)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal * (1.0 - values["droop_at_top"] * _loading(signal, context))


class SlowDroop(Effect):
    """As `Droop`, but the supply's store follows the load with a time constant."""

    name = "amplitude_droop"
    form = "after a while"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (
        Parameter("droop_at_top", "1", 0.0, 0.0, 0.9, 0.01),
        Parameter("store_s", "s", 0.1, 0.005, 5.0, 0.05, scanned=True),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        kept = np.exp(-context.window_s / values["store_s"])
        loading = _loading(signal, context)
        start = np.array([kept * loading[0]])
        held: Array = lfilter([1.0 - kept], [1.0, -kept], loading, zi=start)[0]
        return signal * (1.0 - values["droop_at_top"] * held)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return time constants from two windows to some seconds.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return {"store_s": np.clip(contexts[0].window_s * np.geomspace(2, 300, 8), 0.005, 5.0)}


def _loading(signal: Array, context: Context) -> Array:
    """Power over that at the highest speed of the curve."""
    top_rad_s = float(np.max(np.abs(context.settled_rad_s(context.phase_deg))))
    return (signal / max(top_rad_s, 1e-12)) ** 2


FORMS = (Droop(), SlowDroop())
