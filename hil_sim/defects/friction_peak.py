"""Something in the bearing's cage sings at one speed and takes power there."""

import math
from dataclasses import dataclass
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.plant.rotor import ShaftLoad

_SINGS_AT_RAD_S = 6.0
_WIDTH_RAD_S = 0.8


@dataclass(frozen=True)
class _SingingCage:
    drag_nm: float
    pull_bound_nm: float = 0.0

    def torques_nm(
        self, time_s: float, angle_rad: float, speed_rad_s: float
    ) -> tuple[float, float]:
        off = (abs(speed_rad_s) - _SINGS_AT_RAD_S) / _WIDTH_RAD_S
        return 0.0, self.drag_nm * math.exp(-off * off)


class SingingCage(Defect):
    """At 6 rad/s either way the bearing drags with `size` millinewton metres more."""

    mechanism: ClassVar[str] = "singing_cage"
    cause: ClassVar[str] = ""
    unit: ClassVar[str] = "mN·m"
    typical: ClassVar[float] = 1.5

    def shaft_load(self) -> ShaftLoad:
        """Return the bearing."""
        return _SingingCage(1e-3 * self.size)
