"""What a smaller vibration does: less speed, and a wider dead zone."""

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values


class WeakerDrive(Effect):
    """v′(φ) = (1 − s) v(φ − w sign φ): the crests are lower, so friction holds for longer.

    At one operating point every cause that lowers the vibration looks like this.
    """

    stage = "settled"
    parameters = (
        Parameter("speed_lost", "1", 0.0, -2.0, 0.9, 0.01),
        Parameter("dead_zone_wider_deg", "deg", 0.0, -10.0, 40.0, 0.5),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        phase_deg = context.phase_deg
        inward_deg = phase_deg - values["dead_zone_wider_deg"] * np.sign(phase_deg)
        change = context.settled_rad_s(inward_deg) - context.settled_rad_s(phase_deg)
        narrowed: Array = (1.0 - values["speed_lost"]) * (signal + change)
        return narrowed
