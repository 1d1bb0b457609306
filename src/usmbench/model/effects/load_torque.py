"""A steady torque that the simulation does not know."""

import numpy as np

from usmbench.model.effects.base import Array, Context, Effect, Parameter, Values

_MEANING = "A steady torque acts on the shaft that the simulation does not know."
_MEND = "Look for a weight, a rubbing seal, a misaligned coupling or a brake that is not quite off."


def _braked(signal: Array, loss_rad_s: Array) -> Array:
    """Take a loss from a speed; the torque cannot start a rotor that the contact holds."""
    slower = signal - loss_rad_s
    reversed_way = signal * slower < 0.0
    return np.where((signal == 0.0) | reversed_way, 0.0, slower)


class Weight(Effect):
    """v′ = v − w while the rotor runs: a weight on a drum, on the straight speed–torque curve."""

    name = "load_torque"
    form = "weight"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (Parameter("one_sided_rad_s", "rad/s", 0.0, -30.0, 30.0, 0.02),)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return _braked(signal, np.full(signal.shape, values["one_sided_rad_s"]))


class Drag(Effect):
    """v′ = v − d sign(v) while the rotor runs: dry friction outside the motor."""

    name = "load_torque"
    form = "drag"
    meaning = _MEANING
    mend = _MEND
    stage = "settled"
    parameters = (Parameter("drag_rad_s", "rad/s", 0.0, -3.0, 30.0, 0.02),)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return _braked(signal, values["drag_rad_s"] * np.sign(signal))


FORMS = (Weight(), Drag())
