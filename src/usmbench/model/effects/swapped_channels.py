"""The speed has the other sign."""

from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import DEFINITION, Array, Effect, Stage, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter


class SwappedChannels(Effect):
    """ω′ = −ω: what leads and what lags of the encoder's two channels changed."""

    name = "swapped_channels"
    meaning = "The speed has the other sign: two channels or the two drive voltages are swapped."
    mend = "Swap channels A and B of the encoder, or the two drive outputs, back."
    stage: ClassVar[Stage] = "counter"
    form_off = DEFINITION
    parameters: ClassVar[tuple[Parameter, ...]] = ()

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported, or the phase that reaches the motor.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return np.negative(signal)


class SwappedOutputs(SwappedChannels):
    """φ′ = −φ: on a motor that is not alike both ways it is more than the other sign."""

    form = "of the drive"
    stage = "command"


FORMS = (SwappedChannels(), SwappedOutputs())
