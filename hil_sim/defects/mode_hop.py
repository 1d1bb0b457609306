"""The ring falls into another mode in a band of phases: it vibrates less there."""

from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import DrivePath
from hil_sim.signals import Drive

_BAND_DEG = (38.0, 57.0)


class ModeHop(Defect):
    """Between 38 and 57 degrees a mode beside the driven one takes `size` per cent of the drive."""

    mechanism: ClassVar[str] = "mode_hop"
    cause: ClassVar[str] = ""
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 0.3
    most: ClassVar[float] = 100.0

    def drive_path(self) -> DrivePath:
        """Return the drive that is left."""
        left = 1.0 - 0.01 * self.size

        def formed(_time_s: float, drive: Drive) -> Drive:
            inside = _BAND_DEG[0] <= drive.phase_deg <= _BAND_DEG[1]
            return drive.scaled(left) if inside else drive

        return DrivePath(formed)
