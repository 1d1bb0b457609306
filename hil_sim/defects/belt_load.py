"""A belt with a seam drags at every turn of its own, which is no turn of the shaft."""

import math
from dataclasses import dataclass
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.plant.rotor import ShaftLoad

_TURNS_OF_BELT_PER_TURN = 0.387


@dataclass(frozen=True)
class _Belt:
    swing_nm: float

    @property
    def pull_bound_nm(self) -> float:
        return self.swing_nm

    def torques_nm(
        self, time_s: float, angle_rad: float, speed_rad_s: float
    ) -> tuple[float, float]:
        return self.swing_nm * math.sin(_TURNS_OF_BELT_PER_TURN * angle_rad), 0.0


class SeamedBelt(Defect):
    """The belt's pull swings by `size` millinewton metres either way."""

    mechanism: ClassVar[str] = "seamed_belt"
    cause: ClassVar[str] = ""
    unit: ClassVar[str] = "mN·m"
    typical: ClassVar[float] = 0.9

    def shaft_load(self) -> ShaftLoad:
        """Return the belt."""
        return _Belt(1e-3 * self.size)
