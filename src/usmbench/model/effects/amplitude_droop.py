"""The drive's amplitude droops with load."""

from collections.abc import Sequence

import numpy as np
from scipy.signal import lfilter

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values
from usmbench.model.effects.weaker_drive import travelling, weaker

_MEANING = "The drive voltages give way while the motor delivers power: fast is slower than it was."
_MEND = "Watch both amplitudes at full speed and at 0°; look at the supply, its cable and fuse."
_SIZE = (
    Parameter("droop_at_top", "1", 0.0, 0.0, 0.9, 0.01),
    Parameter("held_back_rad_s", "rad/s", 0.0, 0.0, 30.0, 0.05),
)


class Droop(Effect):
    """The vibration falls with the power, taken as (v/v_top)², and the speed with it."""

    name = "amplitude_droop"
    form = "at once"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = _SIZE

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return _drooped(signal, context, values, travelling(signal, context))


class SlowDroop(Effect):
    """As `Droop`, but the supply's store follows the load with a time constant."""

    name = "amplitude_droop"
    form = "after a while"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (
        *_SIZE,
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
        loading = travelling(signal, context)
        start = np.array([kept * loading[0]])
        held: Array = lfilter([1.0 - kept], [1.0, -kept], loading, zi=start)[0]
        return _drooped(signal, context, values, held)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return time constants from two windows to some seconds.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return {"store_s": np.clip(contexts[0].window_s * np.geomspace(2, 300, 8), 0.005, 5.0)}


def _drooped(signal: Array, context: Context, values: Values, loading: Array) -> Array:
    """Weaken the drive by its load."""
    lost, held_rad_s = values["droop_at_top"] * loading, values["held_back_rad_s"] * loading
    return weaker(signal, context, lost, held_rad_s)


FORMS = (Droop(), SlowDroop())
