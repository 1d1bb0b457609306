"""What is asked of the bench's loop from other threads."""

from collections.abc import Callable
from dataclasses import dataclass

from usmbench.bluesky.status import DeviceStatus
from usmbench.errors import BenchError
from usmbench.settings.plan import DwellSettings
from usmbench.sweep.drive import Setting
from usmbench.sweep.rows import WindowRow
from usmbench.sweep.settling import Settling

Change = Callable[[Setting], Setting]


@dataclass(slots=True)
class Measurement:
    """A dwell's speed, under way or done.

    Parameters
    ----------
    dwell
        When it counts as settled.
    status
        Done when the measurement is.
    settling
        The speeds so far.
    row
        The last window of it.
    """

    dwell: DwellSettings
    status: DeviceStatus
    settling: Settling
    row: WindowRow | None = None


@dataclass(frozen=True, slots=True)
class Acknowledgement:
    """What tripped an interlock has been mended.

    Parameters
    ----------
    trip
        That interlock; None for none.
    """

    trip: BenchError | None


Wanted = Change | Measurement | Acknowledgement | None  # None: the drive off
Request = tuple[Wanted, DeviceStatus]
