"""Isolated false counts."""

import math

import numpy as np

from usmbench.model.effects.base import Array, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.lone_windows import LoneWindows, SporadicEffect, Weighed
from usmbench.model.effects.parameter import Parameter

_SEED = 20_240_229


class CountGlitches(SporadicEffect):
    """Windows with false counts at random moments: spikes of a typical size, either sign.

    Which windows are hit cannot be foreseen: the extended simulation draws them, always the same
    for the same run.
    """

    name = "count_glitches"
    meaning = "Isolated windows hold false counts: spikes that have nothing to do with the motion."
    mend = "Look at the encoder's cable, shield and ground; raise the counter's digital filter."
    sizes = ("size_rad_s",)
    parameters = (
        Parameter(
            "rate_hz", "1/s", 0.0, 0.0, 100.0, 0.1, what="windows with a false count, per second"
        ),
        Parameter(
            "size_rad_s",
            "rad/s",
            0.0,
            0.0,
            1e4,
            1.0,
            what="by how much the speed of such a window is off, median, either way",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        draw = np.random.default_rng(_SEED)
        hit = self.struck(draw, context, values["rate_hz"])
        way = np.where(draw.random(signal.size) < 0.5, -1.0, 1.0)
        spiked: Array = signal + values["size_rad_s"] * hit * way
        return spiked

    def weigh(self, windows: LoneWindows) -> Weighed:
        """Return how well false counts fit: as often at any speed, and either way.

        Parameters
        ----------
        windows
            The windows, of which some stand alone.
        """
        every = np.ones(windows.alone.size, dtype=np.bool_)
        odds = float(np.clip(np.mean(windows.alone), 1e-9, 1.0 - 1e-9))
        count = int(np.count_nonzero(windows.alone))
        likely = count * math.log(0.5 * odds) + (every.size - count) * math.log1p(-odds)
        return Weighed(
            likely, {"rate_hz": windows.rate_hz(every), "size_rad_s": windows.size_rad_s(every)}
        )


FORMS = (CountGlitches(),)
