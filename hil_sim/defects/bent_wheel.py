"""The code wheel is bent: the sensor sees its lines closer and wider twice a turn."""

from typing import ClassVar

import numpy as np

from hil_sim.defects.defect import Defect
from hil_sim.plant.disc import DiscError

_FIRST_RAD = 0.4


class BentWheel(Defect):
    """The pattern is ahead and behind by `size` milliradians, twice a turn."""

    mechanism: ClassVar[str] = "bent_wheel"
    cause: ClassVar[str] = ""
    unit: ClassVar[str] = "mrad"
    typical: ClassVar[float] = 0.7

    def disc_error(self) -> DiscError:
        """Return the error of the bent pattern."""
        swing_rad, start = 1e-3 * self.size, float(np.sin(2.0 * _FIRST_RAD))
        return lambda angle_rad: swing_rad * (np.sin(2.0 * (angle_rad + _FIRST_RAD)) - start)
