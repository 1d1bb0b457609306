"""A cable comes to lie on the shaft for some seconds, and falls off again."""

from dataclasses import dataclass
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.plant.rotor import ShaftLoad

_PERIOD_S = 23.0
_LIES_S = 4.0
_FROM_S = 9.0


@dataclass(frozen=True)
class _Cable:
    drag_nm: float
    pull_bound_nm: float = 0.0

    def torques_nm(
        self, time_s: float, angle_rad: float, speed_rad_s: float
    ) -> tuple[float, float]:
        lies = _FROM_S <= time_s % _PERIOD_S < _FROM_S + _LIES_S
        return 0.0, self.drag_nm if lies else 0.0


class RubbingCable(Defect):
    """While it lies there the cable drags with `size` millinewton metres."""

    mechanism: ClassVar[str] = "rubbing_cable"
    cause: ClassVar[str] = ""
    unit: ClassVar[str] = "mN·m"
    typical: ClassVar[float] = 1.4

    def shaft_load(self) -> ShaftLoad:
        """Return the cable."""
        return _Cable(1e-3 * self.size)
