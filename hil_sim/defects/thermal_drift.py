"""The stator heats more than it did: its resonance moves further under a drive that stays."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.plant import PlantParameters


class LossyCeramic(Defect):
    """The ceramic loses `size` watts more at nominal voltage."""

    mechanism: ClassVar[str] = "lossy_ceramic"
    cause: ClassVar[str] = "thermal_drift"
    unit: ClassVar[str] = "W"
    typical: ClassVar[float] = 1.0
    most: ClassVar[float] = 1000.0  # far beyond any cooling

    def motor(self, healthy: PlantParameters) -> PlantParameters:
        """Return the motor with more loss."""
        thermal = healthy.thermal
        loss_w = thermal.dielectric_loss_w + self.size
        return replace(healthy, thermal=replace(thermal, dielectric_loss_w=loss_w))
