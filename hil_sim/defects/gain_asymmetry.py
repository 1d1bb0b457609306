"""The friction layer has bedded in one way: a backward wave drags less well than a forward one."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import SignedDefect
from hil_sim.plant import PlantParameters


class LeaningTeeth(SignedDefect):
    """The stator's crests move the rotor `size` per cent less far backwards than forwards."""

    mechanism: ClassVar[str] = "leaning_teeth"
    cause: ClassVar[str] = "gain_asymmetry"
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 0.15

    def motor(self, healthy: PlantParameters) -> PlantParameters:
        """Return the motor with such teeth."""
        contact = replace(healthy.contact, backward_ratio=1.0 - 0.01 * self.size)
        return replace(healthy, contact=contact)
