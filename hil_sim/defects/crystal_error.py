"""The board's crystal is off: every frequency is."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import SignedDefect
from hil_sim.defects.paths import DrivePath


class OffCrystal(SignedDefect):
    """The crystal's frequency is `size` ppm high."""

    mechanism: ClassVar[str] = "off_crystal"
    cause: ClassVar[str] = "crystal_error"
    unit: ClassVar[str] = "ppm"
    typical: ClassVar[float] = 15.0
    least: ClassVar[float] = -999_999.0  # a frequency is left

    def drive_path(self) -> DrivePath:
        """Return the generators on this crystal."""
        ratio = 1.0 + 1e-6 * self.size
        return DrivePath(
            lambda _time_s, drive: replace(drive, frequency_hz=ratio * drive.frequency_hz)
        )
