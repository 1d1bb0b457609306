"""The network that shifts the phase has another gain: it turns too far, or not far enough."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import SignedDefect
from hil_sim.defects.paths import DrivePath
from hil_sim.signals import Drive


class AgedShifter(SignedDefect):
    """The shifter of generator B turns by `size` per cent more than its control voltage says."""

    mechanism: ClassVar[str] = "aged_shifter"
    cause: ClassVar[str] = "phase_scale"
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 0.4
    least: ClassVar[float] = -100.0

    def drive_path(self) -> DrivePath:
        """Return the path through the shifter."""
        volt_per_deg = 1.0 / 90.0
        turned_deg_per_volt = (100.0 + self.size) / (100.0 * volt_per_deg)

        def formed(_time_s: float, drive: Drive) -> Drive:
            control_volt = drive.phase_deg * volt_per_deg
            return replace(drive, phase_deg=control_volt * turned_deg_per_volt)

        return DrivePath(formed)
