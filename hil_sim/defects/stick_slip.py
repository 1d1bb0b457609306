"""Boundary lubrication in the bearing: friction that falls as it begins to turn."""

import math
from dataclasses import dataclass
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.plant.rotor import ShaftLoad

# Stribeck speed of a dry plain bearing, where the excess friction has fallen to 1/e.
_STRIBECK_RAD_S = 0.8


@dataclass(frozen=True)
class _Stribeck:
    excess_nm: float
    pull_bound_nm: float = 0.0

    def torques_nm(
        self, time_s: float, angle_rad: float, speed_rad_s: float
    ) -> tuple[float, float]:
        return 0.0, self.excess_nm * math.exp(-((speed_rad_s / _STRIBECK_RAD_S) ** 2))


class DryBearing(Defect):
    """Near rest the bearing rubs with `size` millinewton metres more than in motion."""

    mechanism: ClassVar[str] = "dry_bearing"
    cause: ClassVar[str] = "stick_slip"
    unit: ClassVar[str] = "mN·m"
    typical: ClassVar[float] = 1.5

    def shaft_load(self) -> ShaftLoad:
        """Return the bearing."""
        return _Stribeck(1e-3 * self.size)
