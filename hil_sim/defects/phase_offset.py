"""The path of amplifier B is longer than that of A: its voltage reaches the stator late."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import SignedDefect
from hil_sim.defects.paths import DrivePath
from hil_sim.signals import Drive


class AmplifierDelay(SignedDefect):
    """Amplifier B passes its voltage on later than amplifier A, by `size` nanoseconds."""

    mechanism: ClassVar[str] = "amplifier_delay"
    cause: ClassVar[str] = "phase_offset"
    unit: ClassVar[str] = "ns"
    typical: ClassVar[float] = 4.0

    def drive_path(self) -> DrivePath:
        """Return the late path."""
        lag_s = 1e-9 * self.size

        def formed(_time_s: float, drive: Drive) -> Drive:
            lag_deg = 360.0 * drive.frequency_hz * lag_s
            return replace(drive, phase_deg=drive.phase_deg - lag_deg)

        return DrivePath(formed)
