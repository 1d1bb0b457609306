"""All speeds are off by one factor."""

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values


class SpeedScale(Effect):
    """ω′ = ω (1 + s): another number of counts a revolution, or another motor gain."""

    name = "speed_scale"
    meaning = "All speeds differ from the simulation by one factor."
    mend = "Check counts_per_rev against the disc, the sample clock, and the drive amplitude."
    stage = "counter"
    parameters = (Parameter("scale_error", "1", 0.0, -0.9, 3.0, 0.01),)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return signal * (1.0 + values["scale_error"])


FORMS = (SpeedScale(),)
