"""Friction that sticks: what breaks the rotor loose is more than what keeps it going."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.plant import PlantParameters


class StickyFriction(Defect):
    """Friction at rest is `size` per cent above friction in motion."""

    mechanism: ClassVar[str] = "sticky_friction"
    cause: ClassVar[str] = "dead_zone_hysteresis"
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 10.0

    def motor(self, healthy: PlantParameters) -> PlantParameters:
        """Return the motor whose contact sticks."""
        rotor = replace(healthy.rotor, breakaway_ratio=1.0 + 0.01 * self.size)
        return replace(healthy, rotor=rotor)
