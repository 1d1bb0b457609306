"""The disc sits beside the shaft's centre: the sensor sees the pattern swing once a turn."""

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hil_sim.defects.defect import Defect
from hil_sim.plant.disc import DiscError

# HEDS-5140 (HEDS-51xx/61xx data sheet): optical radius of the code wheel.
_OPTICAL_RADIUS_UM = 11_000.0
# Where the disc is highest when the shaft is at its start.
_HIGH_AT_RAD = 0.9


class EccentricDisc(Defect):
    """The disc's centre is `size` micrometres beside the shaft's."""

    mechanism: ClassVar[str] = "eccentric_disc"
    cause: ClassVar[str] = "encoder_eccentricity"
    unit: ClassVar[str] = "µm"
    typical: ClassVar[float] = 15.0
    most: ClassVar[float] = _OPTICAL_RADIUS_UM

    def disc_error(self) -> DiscError:
        """Return the angle between shaft and pattern, as the sensor at a fixed place sees it."""
        ratio = self.size / _OPTICAL_RADIUS_UM

        def seen(angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
            turned = angle_rad + _HIGH_AT_RAD
            return np.arctan2(ratio * np.sin(turned), 1.0 - ratio * np.cos(turned))

        start_rad = math.atan2(ratio * math.sin(_HIGH_AT_RAD), 1.0 - ratio * math.cos(_HIGH_AT_RAD))
        return lambda angle_rad: seen(angle_rad) - start_rad
