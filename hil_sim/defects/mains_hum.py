"""The amplifiers' supply hums at the mains frequency, which the windows turn into a beat."""

import math
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import DrivePath
from hil_sim.signals import Drive

# 50 Hz less what a grid is off on a bad day; windows of 10 ms take two samples of each period.
_MAINS_HZ = 49.96
# A tenth of a period: what steps this small leave out is beyond the rotor.
_RENEW_S = 0.002


class HummingSupply(Defect):
    """Both voltages swing by `size` per cent at the mains frequency."""

    mechanism: ClassVar[str] = "humming_supply"
    cause: ClassVar[str] = ""
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 0.35
    most: ClassVar[float] = 100.0

    def drive_path(self) -> DrivePath:
        """Return the supply."""
        depth = 0.01 * self.size

        def formed(time_s: float, drive: Drive) -> Drive:
            return drive.scaled(1.0 + depth * math.sin(2.0 * math.pi * _MAINS_HZ * time_s))

        return DrivePath(formed, renew_s=_RENEW_S)
