"""The generator's crystal is off: both drive frequencies are."""

from usmbench.model.effects.weaker_drive import WeakerDrive


class CrystalError(WeakerDrive):
    """The drive sits elsewhere on the resonance, and vibrates less (or more) than it did."""

    name = "crystal_error"
    meaning = "The drive frequency is not the one commanded, so the motor vibrates less or more."
    mend = "Measure the drive frequency with a counter; look at the generator's crystal."


FORMS = (CrystalError(),)
