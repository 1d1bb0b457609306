"""Something heavy turns with the shaft: it takes longer to get up to speed."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.plant import PlantParameters


class Flywheel(Defect):
    """The moment of inertia of all that turns is `size` per cent larger."""

    mechanism: ClassVar[str] = "flywheel"
    cause: ClassVar[str] = "slow_dynamics"
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 10.0

    def motor(self, healthy: PlantParameters) -> PlantParameters:
        """Return the motor with the flywheel."""
        inertia = healthy.rotor.inertia_kg_m2 * (1.0 + 0.01 * self.size)
        return replace(healthy, rotor=replace(healthy.rotor, inertia_kg_m2=inertia))
