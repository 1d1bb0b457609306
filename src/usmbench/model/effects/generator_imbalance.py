"""The generators are not equally strong."""

from usmbench.model.effects.weaker_drive import WeakerDrive


class GeneratorImbalance(WeakerDrive):
    """One standing wave is lower than the other: less of the vibration travels."""

    name = "generator_imbalance"
    meaning = "One of the two drive voltages is weaker than the other."
    mend = "Compare the two amplitudes on an oscilloscope; look at the amplifiers and the filters."


FORMS = (GeneratorImbalance(),)
