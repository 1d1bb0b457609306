"""One direction is faster."""

from typing import ClassVar

import numpy as np

from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter

_MEANING = "The motor is faster in one direction than in the other, against the simulation."
_MEND = "Compare the two channels' amplitudes, and swap them: the fast direction must swap too."


class GainAsymmetry(Effect):
    """v′ = v (1 + a/2) forwards, v (1 − a/2) backwards."""

    name = "gain_asymmetry"
    form = "balanced"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (
        Parameter(
            "asymmetry",
            "1",
            0.0,
            -1.5,
            1.5,
            0.01,
            what="forwards less backwards, over the simulated speed; each takes half",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal + 0.5 * values["asymmetry"] * np.abs(signal)


class OneWay(Effect):
    """v′ = v (1 + g) in one direction, v in the other."""

    name = "gain_asymmetry"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    # At most twice as fast: threefold, less of everything turns it into a sign that is lost.
    parameters = (
        Parameter(
            "gain",
            "1",
            0.0,
            -1.0,
            1.0,
            0.01,
            what="share by which it is faster in the direction of the form; negative is slower",
        ),
    )
    sign: ClassVar[float]

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal + values["gain"] * self.sign * np.maximum(self.sign * signal, 0.0)


class Forwards(OneWay):
    """Only forwards."""

    form = "forwards"
    sign = 1.0


class Backwards(OneWay):
    """Only backwards."""

    form = "backwards"
    sign = -1.0


FORMS = (GainAsymmetry(), Forwards(), Backwards())
