"""The phase moves by another share than is commanded."""

from usmbench.model.effects.base import DEFINITION, Array, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter


class PhaseScale(Effect):
    """φ′ = (1 + e) φ: a phase shifter's gain, a generator's word per degree, a column's unit."""

    name = "phase_scale"
    form_off = DEFINITION
    meaning = "The drive phase moves by another share than is commanded."
    mend = (
        "Measure the phase between the amplifier outputs at two commanded phases; check the "
        "generator's words per degree, and how the column of phases was scaled."
    )
    stage = "command"
    parameters = (
        Parameter(
            "scale_error",
            "1",
            0.0,
            -0.9,
            2.0,
            0.005,
            what="true phase over the commanded one, less 1",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the phase that reaches the motor.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal * (1.0 + values["scale_error"])


FORMS = (PhaseScale(),)
