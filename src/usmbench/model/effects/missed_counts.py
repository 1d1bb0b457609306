"""Counts are lost above some speed."""

from collections.abc import Sequence

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values

_MEANING = "The counter loses counts above some speed."
_MEND = "Check the counter's filter and input rate, the encoder's supply, and its cable."
_THRESHOLD = Parameter("above_rad_s", "rad/s", 1.0, 0.0, 1e3, 0.5, scanned=True)


class LostExcess(Effect):
    """|ω′| = ω₀ + (1 − s)(|ω| − ω₀) above ω₀: a counter that cannot follow."""

    name = "missed_counts"
    form = "of the excess"
    meaning = _MEANING
    mend = _MEND
    stage = "counter"
    parameters = (Parameter("share_lost", "1", 0.0, 0.0, 1.0, 0.05), _THRESHOLD)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        excess = np.maximum(np.abs(signal) - values["above_rad_s"], 0.0)
        return signal - values["share_lost"] * np.sign(signal) * excess

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return thresholds within the upper part of the speeds.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return {"above_rad_s": _thresholds_rad_s(contexts)}


class LostShare(LostExcess):
    """ω′ = (1 − s) ω above ω₀: every so many counts is missed once edges come too fast."""

    form = "of all"

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the speed that is reported.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        above = np.abs(signal) > values["above_rad_s"]
        return signal * np.where(above, 1.0 - values["share_lost"], 1.0)


def _thresholds_rad_s(contexts: Sequence[Context]) -> Array:
    """From a quarter of the highest speed to just below it."""
    top = max(float(np.max(np.abs(c.settled_rad_s(c.phase_deg)))) for c in contexts)
    return np.asarray(top * np.linspace(0.25, 0.98, 38), dtype=np.float64)


FORMS = (LostExcess(), LostShare())
