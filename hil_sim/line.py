"""One direction of the serial line: bytes take their time, and faults hit them on the way."""

from typing import Final, NamedTuple

from hil_sim.faults import BYTE_KINDS, FaultKind, FaultSchedule
from usmbench.instruments.protocol._generated import BAUD, BITS_PER_BYTE

BYTE_S: Final = BITS_PER_BYTE / BAUD
"""Time one byte takes on the line."""


class Arrival(NamedTuple):
    """A byte that came through.

    Parameters
    ----------
    time_s
        Simulated time of its end.
    byte
        Its value.
    late
        Whether a fault held it up, or a byte before it.
    """

    time_s: float
    byte: int
    late: bool


class Line:
    """One direction of the line.

    Parameters
    ----------
    direction
        "to_board" or "to_host".
    faults
        The run's faults; those of the other direction are left alone.
    """

    def __init__(self, direction: str, faults: FaultSchedule):
        ours = (direction, "both")
        self._pending = [f for f in faults.of(*BYTE_KINDS) if f.direction in ours]
        self._silences = [f for f in faults.of(FaultKind.BOARD_SILENT) if f.direction in ours]
        self._free_s = 0.0
        self._late_until_s = -1.0

    def send(self, data: bytes, at_s: float) -> list[Arrival]:
        """Put bytes on the line and return those that arrive, with their times.

        Parameters
        ----------
        data
            The bytes.
        at_s
            Simulated time from which they may be sent; they queue behind what is under way.
        """
        arrivals = []
        for byte in data:
            arrivals += self._pass(byte, at_s)
        return arrivals

    def _pass(self, byte: int, at_s: float) -> list[Arrival]:
        """Put one byte through the faults that are due."""
        end_s = max(at_s, self._free_s) + BYTE_S
        copies = 1
        while self._pending and self._pending[0].time_s <= end_s:
            fault = self._pending.pop(0)
            if fault.kind is FaultKind.FLIPPED_BYTE:
                byte ^= 1 << fault.bit
            elif fault.kind is FaultKind.LATE_BYTE:
                end_s += fault.delay_s
                self._late_until_s = end_s
            else:
                copies = 0 if fault.kind is FaultKind.LOST_BYTE else 2
        late = at_s < self._late_until_s
        times_s = [end_s + copy * BYTE_S for copy in range(copies)]
        self._free_s = times_s[-1] if times_s else end_s
        return [
            Arrival(time_s, byte, late)
            for time_s in times_s
            if not any(s.time_s <= time_s < s.end_s for s in self._silences)
        ]
