"""The two drive phases are not where they are commanded."""

from usmbench.model.effects.base import DEFINITION, Array, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter


class PhaseOffset(Effect):
    """φ′ = φ + offset: a constant angle between the two channels, from cables or amplifiers."""

    name = "phase_offset"
    form_off = DEFINITION
    meaning = "The two drive phases are a constant angle away from where they are commanded."
    mend = "Measure the phase between the amplifier outputs at 0° with an oscilloscope."
    stage = "command"
    parameters = (
        Parameter(
            "offset_deg", "deg", 0.0, -60.0, 60.0, 0.2, what="true phase less the commanded one"
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the phase that reaches the motor.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal + values["offset_deg"]


FORMS = (PhaseOffset(),)
