"""One encoder channel is dead: the sign of the speed is lost."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Values


class UnsignedCounts(Effect):
    """ω′ = |ω|: without the second channel the counter counts every edge upward."""

    name = "unsigned_counts"
    meaning = "The sign of the speed is lost: one channel of the encoder is dead."
    mend = "Check both encoder channels with an oscilloscope, and the counter's decoding mode."
    stage = "counter"
    parameters = ()

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return np.abs(signal)

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why where the motor should never turn backwards.

        Parameters
        ----------
        contexts
            All stretches.
        """
        lowest = min(float(np.min(c.settled_rad_s(c.phase_deg))) for c in contexts)
        return None if lowest < 0.0 else "no command turns the motor backwards"


FORMS = (UnsignedCounts(),)
