"""The speed has the other sign."""

from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import DEFINITION, Array, Context, Effect, Parameter, Values


class SwappedChannels(Effect):
    """ω′ = −ω: what leads and what lags of two channels, or of the two drive voltages, changed."""

    name = "swapped_channels"
    meaning = "The speed has the other sign: two channels or the two drive voltages are swapped."
    mend = "Swap channels A and B of the encoder, or the two drive outputs, back."
    stage = "counter"
    form_off = DEFINITION
    parameters: ClassVar[tuple[Parameter, ...]] = ()

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return np.negative(signal)


FORMS = (SwappedChannels(),)
