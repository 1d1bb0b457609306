"""The generators are not equally strong."""

from dataclasses import replace

from usmbench.model.effects.base import Array, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.resonance import AlongResonance, vibrating_less
from usmbench.model.effects.weaker_drive import HELD_BACK, LOST, WeakerDrive

_MEANING = "One of the two drive voltages is weaker than the other."
_MEND = "Compare the two amplitudes on an oscilloscope; look at the amplifiers and the filters."
_LOST = replace(LOST, what="share of the highest speed that is lost")


class GeneratorImbalance(AlongResonance):
    """One standing wave is lower than the other: the crests are lower, at every frequency alike.

    The waves that run either way differ in energy by the product of both voltages, so the highest
    speed falls with its root, and nothing raises it.
    """

    name = "generator_imbalance"
    form = "along the resonance"
    meaning = _MEANING
    mend = _MEND
    parameters = (_LOST,)

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return vibrating_less(signal, context, values["speed_lost"])


class UnknownSlope(WeakerDrive):
    """What it does at one frequency, of whose slope nothing is known."""

    name = "generator_imbalance"
    meaning = _MEANING
    mend = _MEND
    parameters = (_LOST, HELD_BACK)


FORMS = (GeneratorImbalance(), UnknownSlope())
