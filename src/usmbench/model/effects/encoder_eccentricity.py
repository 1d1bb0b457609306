"""Once-per-revolution ripple."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values, middle_rad

_TURNS = 0.1  # an arc in which a ripple bends by a twentieth of itself


class EncoderEccentricity(Effect):
    """ω′ = ω (1 + c cos α + s sin α): the disc's centre is off the axis of rotation.

    With the disc off by e and read at radius R, the marks pass with ω (1 + (e/R) cos(α − α₀)).
    """

    name = "encoder_eccentricity"
    meaning = "The encoder's disc is off centre: a ripple once a revolution, relative to the speed."
    mend = "Centre the disc, or calibrate it by an average over whole revolutions."
    stage = "counter"
    early = True  # a counter counts what passes it
    parameters = (
        Parameter("cosine", "1", 0.0, -0.5, 0.5, 0.005),
        Parameter("sine", "1", 0.0, -0.5, 0.5, 0.005),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        angle_rad = context.angle_rad
        if angle_rad is None:
            angle_rad = middle_rad(signal, context.window_s)
        ripple = values["cosine"] * np.cos(angle_rad) + values["sine"] * np.sin(angle_rad)
        return signal * (1.0 + ripple)

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why where the shaft never turns far enough.

        Parameters
        ----------
        contexts
            All stretches.
        """
        known = [c.angle_rad for c in contexts if c.angle_rad is not None]
        turns = max((float(np.ptp(a)) / (2.0 * np.pi) for a in known), default=_TURNS)
        if turns >= _TURNS:
            return None
        return f"the shaft turns {turns:.2f} times; a ripple once a revolution needs {_TURNS:g}"


FORMS = (EncoderEccentricity(),)
