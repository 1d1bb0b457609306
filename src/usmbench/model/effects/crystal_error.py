"""The generator's crystal is off: both drive frequencies are."""

from dataclasses import replace

from usmbench.model.effects.base import Array, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.resonance import AlongResonance, detuned
from usmbench.model.effects.weaker_drive import HELD_BACK, LOST, WeakerDrive

_MEANING = "The drive frequency is not the one commanded, so the motor vibrates less or more."
_MEND = "Measure the drive frequency with a counter; look at the generator's crystal."


class CrystalError(AlongResonance):
    """v′ = v + p f ∂v/∂f: faster on one side of the resonance, slower on the other."""

    name = "crystal_error"
    form = "along the resonance"
    meaning = _MEANING
    mend = _MEND
    parameters = (
        Parameter(
            "frequency_error_ppm",
            "ppm",
            0.0,
            -5000.0,
            5000.0,
            5.0,
            what="true drive frequency less the commanded one; positive is above it",
        ),
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        signal, context, values
            As in `Effect.apply`.
        """
        return detuned(signal, context, 1e-6 * values["frequency_error_ppm"])


class FartherFromResonance(WeakerDrive):
    """What it does at one frequency, of whose slope nothing is known: the motor vibrates less."""

    name = "crystal_error"
    meaning = _MEANING
    mend = _MEND


class NearerResonance(FartherFromResonance):
    """It vibrates more: faster, and friction holds less. Never faster, and held more."""

    form = "nearer the resonance"
    parameters = (
        replace(LOST, low=-2.0, high=0.0, what="share of the speed that is lost: it is gained"),
        replace(
            HELD_BACK,
            low=-30.0,
            high=0.0,
            what="speed that friction takes as well, most near standstill: it takes less",
        ),
    )


FORMS = (CrystalError(), FartherFromResonance(), NearerResonance())
