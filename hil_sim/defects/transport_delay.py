"""The board's firmware queues commands: they reach the generators late."""

from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import DrivePath


class CommandQueue(Defect):
    """A command waits `size` milliseconds before it acts."""

    mechanism: ClassVar[str] = "command_queue"
    cause: ClassVar[str] = "transport_delay"
    unit: ClassVar[str] = "ms"
    typical: ClassVar[float] = 0.3

    def drive_path(self) -> DrivePath:
        """Return the queue."""
        return DrivePath(lambda _time_s, drive: drive, delay_s=1e-3 * self.size)
