"""Faults on demand: what goes wrong, when, and where each machine asks for its own.

A schedule is immutable and knows nothing of the machines. Each level takes the faults that happen
there: the line (bytes, silence), the board (resets), the pseudo-terminal (port gone), the data
acquisition (overflow, dead event stream, dead server), the counter (wrap) and the motor
(dead encoder channel, slipped coupling).
"""

import math
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import Final, Literal, get_args

from usmbench.errors import InputError
from usmbench.instruments.protocol._generated import ResetCause

Direction = Literal["to_board", "to_host", "both"]


class FaultKind(StrEnum):
    """What can go wrong; the value is the name in files and on the command line."""

    FLIPPED_BYTE = "flipped_byte"
    """One bit of the first byte on the line from that instant on."""
    LOST_BYTE = "lost_byte"
    """The first byte on the line from that instant on never arrives."""
    DOUBLED_BYTE = "doubled_byte"
    """The first byte on the line from that instant on arrives twice."""
    LATE_BYTE = "late_byte"
    """The first byte on the line from that instant on, and all behind it, arrive `delay_s` late."""
    BOARD_RESET = "board_reset"
    """The board restarts for `cause`: outputs off, nothing remembered."""
    BOARD_SILENT = "board_silent"
    """Bytes on the line are dropped, in `direction`, for `duration_s`."""
    PORT_GONE = "port_gone"
    """The serial port disappears, as an adapter that is pulled out does."""
    DAQ_OVERFLOW = "daq_overflow"
    """Reads end in NI-DAQmx error -200279."""
    EVENT_STREAM_DEAD = "event_stream_dead"
    """The stream of every-N-samples events ends without a word."""
    SERVER_DEAD = "server_dead"
    """The NI device server stops answering."""
    COUNTER_WRAP = "counter_wrap"
    """The counter starts `counts` short of its end, so that it wraps soon; `time_s` must be 0."""
    DEAD_CHANNEL = "dead_channel"
    """Encoder channel `channel` stays at its level for `duration_s`."""
    SLIPPED_COUPLING = "slipped_coupling"
    """The motor turns, the encoder does not, for `duration_s`."""


BYTE_KINDS: Final = (
    FaultKind.FLIPPED_BYTE,
    FaultKind.LOST_BYTE,
    FaultKind.DOUBLED_BYTE,
    FaultKind.LATE_BYTE,
)

OPTIONS: Final[dict[FaultKind, frozenset[str]]] = {
    FaultKind.FLIPPED_BYTE: frozenset({"direction", "bit"}),
    FaultKind.LOST_BYTE: frozenset({"direction"}),
    FaultKind.DOUBLED_BYTE: frozenset({"direction"}),
    FaultKind.LATE_BYTE: frozenset({"direction", "delay_s"}),
    FaultKind.BOARD_RESET: frozenset({"cause"}),
    FaultKind.BOARD_SILENT: frozenset({"direction", "duration_s"}),
    FaultKind.COUNTER_WRAP: frozenset({"counts"}),
    FaultKind.DEAD_CHANNEL: frozenset({"channel", "duration_s"}),
    FaultKind.SLIPPED_COUPLING: frozenset({"duration_s"}),
}
CAUSES: Final = tuple(cause.name.lower() for cause in ResetCause)


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that goes wrong at one instant.

    Parameters
    ----------
    kind
        What goes wrong.
    time_s
        Simulated time of the instant.
    direction
        Direction of the line that is hit: "to_board", "to_host" or "both".
    bit
        Bit of a flipped byte, 0 the lowest.
    delay_s
        Delay of a late byte.
    cause
        Cause of a board reset, by its name in the protocol description.
    counts
        How far from its end a counter starts that is to wrap.
    channel
        Encoder channel that is dead, "a" or "b".
    duration_s
        How long a lasting fault lasts.

    Raises
    ------
    usmbench.errors.InputError
        A value is out of its range, or the kind has no such option.
    """

    kind: FaultKind
    time_s: float
    direction: Direction = "both"
    bit: int = 0
    delay_s: float = 0.02
    cause: str = "power_on"
    counts: int = 100
    channel: Literal["a", "b"] = "b"
    duration_s: float = math.inf

    def __post_init__(self) -> None:
        allowed = OPTIONS.get(self.kind, frozenset())
        for option in fields(self)[2:]:
            if option.name not in allowed and getattr(self, option.name) != option.default:
                raise InputError(f"the fault {self.kind} has no option {option.name}; leave it out")
        for name, valid, says in (
            ("time_s", 0 <= self.time_s < math.inf, "must be 0 or later"),
            ("direction", self.direction in get_args(Direction), "is to_board, to_host or both"),
            ("bit", self.bit in range(8), "must be 0 to 7"),
            ("delay_s", 0 < self.delay_s < math.inf, "must be positive"),
            ("cause", self.cause in CAUSES, f"is one of {', '.join(CAUSES)}"),
            ("counts", self.counts > 0, "must be positive"),
            ("channel", self.channel in ("a", "b"), "is a or b"),
            ("duration_s", self.duration_s > 0, "must be positive"),
        ):
            if not valid:
                raise InputError(f"fault {self.kind}: {name} {says}, not {getattr(self, name)}")
        if self.kind is FaultKind.COUNTER_WRAP and self.time_s != 0:
            raise InputError("the fault counter_wrap is a preset of the counter; its time is 0")

    @property
    def end_s(self) -> float:
        """Instant from which a lasting fault is over."""
        return self.time_s + self.duration_s

    @property
    def reset_cause(self) -> ResetCause:
        """The cause of a board reset, as the board reports it."""
        return ResetCause[self.cause.upper()]


class FaultSchedule:
    """All faults of one run, in the order of their instants.

    Parameters
    ----------
    faults
        The faults, in any order.
    """

    def __init__(self, faults: tuple[Fault, ...] | list[Fault] = ()):
        self.faults = tuple(sorted(faults, key=lambda fault: fault.time_s))

    def of(self, *kinds: FaultKind) -> tuple[Fault, ...]:
        """Return the faults of these kinds, in the order of their instants.

        Parameters
        ----------
        *kinds
            Which kinds to return.
        """
        return tuple(fault for fault in self.faults if fault.kind in kinds)

    def active(self, kind: FaultKind, time_s: float) -> Fault | None:
        """Return the first fault of a kind that has begun and is not over, or None.

        Parameters
        ----------
        kind
            Which kind to look for.
        time_s
            Simulated time.
        """
        for fault in self.faults:
            if fault.time_s > time_s:
                break
            if fault.kind is kind and time_s < fault.end_s:
                return fault
        return None
