"""All speeds are off by one factor."""

from collections.abc import Sequence
from typing import ClassVar

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Stage, Values


class SpeedScale(Effect):
    """ω′ = ω (1 + s): another number of counts a revolution, or another motor gain."""

    name = "speed_scale"
    meaning = "All speeds differ from the simulation by one factor."
    mend = "Check counts_per_rev against the disc, the sample clock, and the drive amplitude."
    stage: ClassVar[Stage] = "counter"
    parameters = (Parameter("scale_error", "1", 0.0, -0.9, 3.0, 0.01),)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal * (1.0 + values["scale_error"])


class MotorGain(SpeedScale):
    """v′ = v (1 + s): the motor's gain alone, whose jumps a torque limit does not let grow."""

    form = "of the motor"
    stage = "settled"

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why these runs cannot show the cause, or None where they can.

        Parameters
        ----------
        contexts
            All stretches.
        """
        if any(c.linear.slip_limit_rad_s is not None for c in contexts):
            return None
        return "without a torque limit the motor's gain is that of the counter"


FORMS = (SpeedScale(), MotorGain())
