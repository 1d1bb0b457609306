"""An amplifier that is soft: its voltage droops with the current that the vibration draws."""

import math
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import DrivePath
from hil_sim.signals import Drive


class SoftSupply(Defect):
    """Both voltages droop by `size` per cent at ±90°, with the power that the wave carries."""

    mechanism: ClassVar[str] = "soft_supply"
    cause: ClassVar[str] = "amplitude_droop"
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 0.2
    most: ClassVar[float] = 100.0

    def drive_path(self) -> DrivePath:
        """Return the supply."""
        droop = 0.01 * self.size

        def formed(_time_s: float, drive: Drive) -> Drive:
            # The travelling share of the wave does the work, which the supply has to deliver.
            return drive.scaled(1.0 - droop * math.sin(math.radians(drive.phase_deg)) ** 2)

        return DrivePath(formed)
