"""The signal generator board with its very firmware, run in gpsim, in place of the emulated one.

The processor runs one byte's time behind the testbed, so that a byte which ends now can still
start when it did, and runs ahead to the end of each reply, so that it can be handed over at once.
"""

from dataclasses import replace
from typing import Final

from hil_sim.dds_pair import Chips, DdsPair, SpiLog
from hil_sim.gpsim_bridge import CYCLES_PER_SECOND, Event, GpsimBridge
from hil_sim.line import BYTE_S
from hil_sim.signals import Drive
from usmbench.instruments.protocol._generated import DELIMITER, ResetCause

START_UP_CYCLES: Final = CYCLES_PER_SECOND // 1000
"""The first reset is over by then; simulated time starts there."""
BYTE_CYCLES: Final = round(BYTE_S * CYCLES_PER_SECOND)
REPLY_STARTS_CYCLES: Final = CYCLES_PER_SECOND * 6 // 10_000
"""A reply that has not started this long after a frame's end will not come."""

_STOP_BIT_S: Final = BYTE_S * 0.95
# The bridge notes a byte in the middle of its stop bit.
_CAUSE_NAMES: Final = {ResetCause.STACK: "stack_full"}


class GpsimBoard:
    """The board, as `hil_sim.board.Board` is. Times must not fall from call to call.

    Parameters
    ----------
    bridge
        The image in gpsim, not yet run; it is closed by whoever made it.
    spi_log
        Told of every word written to the generators, where given.

    Attributes
    ----------
    replies
        What it has said since the list was last emptied: start of the first byte, and the bytes.
    drive_changes
        Drive voltages since the list was last emptied: the instant, and what holds from then on.
    sync_rises_s
        When the sync pin rose, since the list was last emptied.
    errors
        What the chips' models or the line found wrong. Stays empty on a sound board.
    """

    def __init__(self, bridge: GpsimBridge, *, spi_log: SpiLog | None = None):
        self.replies: list[tuple[float, bytes]] = []
        self.drive_changes: list[tuple[float, Drive]] = []
        self.sync_rises_s: list[float] = []
        self.errors: list[str] = []
        self._bridge = bridge
        self._spi_log = spi_log
        self._dds = DdsPair()
        self._enabled = False
        self._drive = Drive()
        self._reply = bytearray()
        self._reply_start_s = 0.0
        self._frame_began = False
        self._line_free = 0
        self._take(bridge.command(f"run {START_UP_CYCLES}"))

    @property
    def time_s(self) -> float:
        """Simulated time that the processor has reached."""
        return _seconds(self._bridge.cycle)

    def advance(self, time_s: float) -> None:
        """Let time pass.

        Parameters
        ----------
        time_s
            Simulated time.
        """
        cycle = _cycles(time_s - BYTE_S)
        if cycle > self._bridge.cycle:
            self._take(self._bridge.command(f"run {cycle}"))

    def receive(self, byte: int, time_s: float) -> None:
        """Take one byte, and where it ends a frame wait for the reply.

        Parameters
        ----------
        byte
            What came over the line, 0 to 255.
        time_s
            Simulated time of its end.
        """
        self.receive_burst(bytes((byte,)), time_s - BYTE_S)

    def receive_burst(self, data: bytes, time_s: float) -> None:
        """Take bytes that follow each other at once; wait for one reply where they end a frame.

        Parameters
        ----------
        data
            What came over the line, at least one byte.
        time_s
            Simulated time of the first byte's start.
        """
        start = max(_cycles(time_s), self._bridge.cycle)
        self._line_free = max(start, self._line_free) + BYTE_CYCLES * len(data)
        commands = [f"send {data.hex()} {start}"]
        began = self._frame_began if len(data) == 1 else data[-2] != DELIMITER
        if data[-1] == DELIMITER and began:
            commands.append(f"answer {self._line_free + REPLY_STARTS_CYCLES}")
        self._frame_began = data[-1] != DELIMITER
        self._take(self._bridge.command(*commands))

    def reset(self, time_s: float, cause: ResetCause) -> None:
        """Restart: outputs off, nothing remembered.

        Parameters
        ----------
        time_s
            Simulated time.
        cause
            What the status will give as the cause.
        """
        self.advance(time_s)
        name = _CAUSE_NAMES.get(cause, cause.name.lower())
        self._take(self._bridge.command(f"reset {name}"))

    def disturb(self, *commands: str) -> list[Event]:
        """Do to the board what its surroundings might.

        Parameters
        ----------
        commands
            Commands of the bridge, such as "register f8b 0" or "sdata 0".

        Returns
        -------
        list of dict
            What happened meanwhile.
        """
        events = self._bridge.command(*commands)
        self._take(events)
        return events

    def watch_words(self, log: SpiLog) -> None:
        """Tell of every word from here on, in place of the log given before.

        Parameters
        ----------
        log
            What is told.
        """
        self._spi_log = log

    def _take(self, events: list[Event]) -> None:
        for event in events:
            if "byte" in event:
                self._take_byte(event)
            elif "word" in event:
                self._take_word(event)
            elif "enable" in event:
                self._enabled = bool(event["enable"])
                self._note_drive(event["cycle"])
            elif "reset" in event:
                self._reply.clear()
            elif event.get("sync"):
                self.sync_rises_s.append(_seconds(event["cycle"]))
            elif "error" in event:
                self.errors.append(event["error"])

    def _take_byte(self, event: Event) -> None:
        if not self._reply:
            self._reply_start_s = _seconds(event["cycle"]) - _STOP_BIT_S
        self._reply.append(event["byte"])
        if event["byte"] == DELIMITER:
            self.replies.append((self._reply_start_s, bytes(self._reply)))
            self._reply.clear()

    def _take_word(self, event: Event) -> None:
        chips: Chips = event["chips"]
        if chips != "b":
            self._dds.a.write_word(event["word"])
        if chips != "a":
            self._dds.b.write_word(event["word"])
        if self._spi_log is not None:
            self._spi_log(_seconds(event["latched"]), chips, event["word"])
        self._note_drive(event["latched"])

    def _note_drive(self, cycle: int) -> None:
        drive = self._dds.drive
        if not self._enabled:
            drive = replace(drive, amplitude_a=0.0, amplitude_b=0.0)
        if drive != self._drive:
            self._drive = drive
            self.drive_changes.append((_seconds(cycle), drive))


def _cycles(time_s: float) -> int:
    """Return the processor's cycle at a simulated time."""
    return START_UP_CYCLES + round(time_s * CYCLES_PER_SECOND)


def _seconds(cycle: int) -> float:
    """Return the simulated time of a cycle."""
    return (cycle - START_UP_CYCLES) / CYCLES_PER_SECOND
