"""A torque on the shaft that nobody wrote down: a weight on it, or a bearing that drags."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import Defect, SignedDefect
from hil_sim.plant import PlantParameters


class HangingWeight(SignedDefect):
    """A weight on a cord pulls with `size` millinewton metres, whichever way the shaft turns."""

    mechanism: ClassVar[str] = "hanging_weight"
    cause: ClassVar[str] = "load_torque"
    unit: ClassVar[str] = "mN·m"
    typical: ClassVar[float] = 0.6

    def motor(self, healthy: PlantParameters) -> PlantParameters:
        """Return the motor with the weight."""
        return replace(healthy, rotor=replace(healthy.rotor, weight_nm=1e-3 * self.size))


class DraggingBearing(Defect):
    """A bearing rubs with `size` millinewton metres more, against any motion."""

    mechanism: ClassVar[str] = "dragging_bearing"
    cause: ClassVar[str] = "load_torque"
    unit: ClassVar[str] = "mN·m"
    typical: ClassVar[float] = 0.6

    def motor(self, healthy: PlantParameters) -> PlantParameters:
        """Return the motor with the bearing."""
        rotor = healthy.rotor
        friction_nm = rotor.bearing_friction_nm + 1e-3 * self.size
        return replace(healthy, rotor=replace(rotor, bearing_friction_nm=friction_nm))
