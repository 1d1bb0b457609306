"""Generator B is weaker than A: the wave is partly a standing one."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import DrivePath


class WeakGenerator(Defect):
    """Generator B gives `size` per cent less than A."""

    mechanism: ClassVar[str] = "weak_generator"
    cause: ClassVar[str] = "generator_imbalance"
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 0.25
    most: ClassVar[float] = 100.0

    def drive_path(self) -> DrivePath:
        """Return the weak generator."""
        ratio = 1.0 - 0.01 * self.size
        return DrivePath(
            lambda _time_s, drive: replace(drive, amplitude_b=ratio * drive.amplitude_b)
        )
