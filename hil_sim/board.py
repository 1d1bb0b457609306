"""The signal generator board as a machine: bytes in, bytes and drive voltages out.

It does what firmware/PROTOCOL.md asks of any board, and knows nothing of wall clocks or ports.
"""

import math
import struct
from typing import Final

from hil_sim.dds_pair import DdsPair, SpiLog
from hil_sim.frame_receiver import FrameReceiver, build_frame
from hil_sim.signals import Drive
from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import Faults, Flags, Refusal, RequestType, ResetCause

EFFECT_S: Final = {
    RequestType.SET_DRIVE: 112e-6,
    RequestType.SET_PHASE: 63e-6,
    RequestType.OUTPUTS: 42e-6,
}
"""Time from the end of a request's last byte to its effect, as benchmarks/firmware_figures.py finds
it of the firmware."""
TURN_AROUND_S: Final = 44e-6
"""Time from there to the start of the reply's first byte."""
HOST_SILENCE_S: Final = wire.HOST_SILENCE_MS / 1000.0
FIRMWARE_VERSION: Final = (1, 0)
_TRIPS_MAX: Final = 255
_REQUEST_FORMATS: Final = {
    kind: "<" + "".join(code for _, code in layout) for kind, layout in wire.REQUEST_LAYOUTS.items()
}
_REPLY_FORMATS: Final = {
    kind: "<" + "".join(code for _, code in layout) for kind, layout in wire.REPLY_LAYOUTS.items()
}


class _RefusedError(Exception):
    """A request that must not be executed."""

    def __init__(self, reason: Refusal):
        super().__init__(reason.name)
        self.reason = reason


class Board:
    """The emulated board. Times must not fall from call to call.

    Parameters
    ----------
    spi_log
        Told of every word written to the generators, where given.

    Attributes
    ----------
    replies
        What it has said since the list was last emptied: start of the first byte, and the bytes.
    drive_changes
        Drive voltages since the list was last emptied: the instant, and what holds from then on.
    """

    def __init__(self, *, spi_log: SpiLog | None = None):
        self.replies: list[tuple[float, bytes]] = []
        self.drive_changes: list[tuple[float, Drive]] = []
        self._spi_log = spi_log
        self._drive = Drive()
        self._power_on(0.0, ResetCause.POWER_ON)

    def _power_on(self, time_s: float, cause: ResetCause) -> None:
        self._receiver = FrameReceiver()
        self._dds = DdsPair(self._spi_log)
        self._dds.start_up(time_s)
        self._flags = Flags.NOT_IDENTIFIED
        self._faults = Faults(0)
        if cause is ResetCause.STACK:
            self._faults = Faults.STACK
            self._flags |= Flags.INTERNAL_FAULT
        self._reset_cause = cause
        self._silence_trips = 0
        self._last_frame_s = self._effect_s = time_s
        self._acknowledged: tuple[bytes, bytes] | None = None
        self._acknowledgement = b""

    @property
    def silence_trip_s(self) -> float:
        """When the drive stops unless a frame arrives first; infinite while it is off."""
        if self._flags & Flags.OUTPUTS_ON:
            return self._last_frame_s + HOST_SILENCE_S
        return math.inf

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
        # Not before the words that are still on their way, which would start the drive again.
        reset_s = max(time_s, self._effect_s)
        self._power_on(reset_s, cause)
        self._note_drive(reset_s)

    def advance(self, time_s: float) -> None:
        """Let time pass: stops the drive at the very end of a host's silence.

        Parameters
        ----------
        time_s
            Simulated time.
        """
        trip_s = self.silence_trip_s
        if time_s < trip_s:
            return
        self._dds.set_outputs(trip_s, on=False)
        self._flags = self._flags & ~Flags.OUTPUTS_ON | Flags.HOST_SILENCE
        self._silence_trips = min(self._silence_trips + 1, _TRIPS_MAX)
        # The remembered flags are no longer true, and a request resent must act again.
        self._acknowledged = None
        self._note_drive(trip_s)

    def receive(self, byte: int, time_s: float) -> None:
        """Take one byte.

        Parameters
        ----------
        byte
            What came over the line, 0 to 255.
        time_s
            Simulated time of its end.
        """
        self.advance(time_s)
        request = self._receiver.push(byte)
        if request is None or request[1] & wire.ACK_BIT:
            return
        self._last_frame_s = self._effect_s = time_s
        reply = self._answer(request, time_s)
        self.replies.append((self._effect_s + TURN_AROUND_S, reply))

    def _answer(self, request: bytes, time_s: float) -> bytes:
        """Execute a request, unless it is the repeat of the last one acknowledged."""
        sequence, kind, payload = request[0], request[1], request[2:-2]
        sequence_and_crc = (request[:1], request[-2:])
        if sequence_and_crc == self._acknowledged and kind != RequestType.IDENTIFY:
            return self._acknowledgement
        try:
            body = self._execute(kind, payload, time_s)
        except _RefusedError as refused:
            refusal = (sequence, kind | wire.REFUSAL_BITS, refused.reason, self._flags)
            return build_frame(bytes(refusal))
        reply = build_frame(bytes((sequence, kind | wire.ACK_BIT)) + body)
        self._acknowledged = None if kind == RequestType.IDENTIFY else sequence_and_crc
        self._acknowledgement = reply
        return reply

    def _execute(self, kind: int, payload: bytes, time_s: float) -> bytes:
        if kind not in _REQUEST_FORMATS:
            raise _RefusedError(Refusal.UNKNOWN_COMMAND)
        request = RequestType(kind)
        layout = _REQUEST_FORMATS[request]
        if len(payload) != struct.calcsize(layout):
            raise _RefusedError(Refusal.WRONG_LENGTH)
        values = struct.unpack(layout, payload)
        harmless = request in (RequestType.IDENTIFY, RequestType.STATUS) or (
            request is RequestType.OUTPUTS and values[0] == 0
        )
        if self._flags & Flags.NOT_IDENTIFIED and not harmless:
            raise _RefusedError(Refusal.NOT_IDENTIFIED)
        self._effect_s = time_s + EFFECT_S.get(request, 0.0)
        self._act(request, values, self._effect_s)
        self._note_drive(self._effect_s)
        return struct.pack(_REPLY_FORMATS[request], self._flags, *self._reading(request))

    def _act(self, request: RequestType, values: tuple[int, ...], time_s: float) -> None:
        """Give a request its effect; heartbeat and status have none."""
        if request is RequestType.IDENTIFY:
            self._flags &= ~Flags.NOT_IDENTIFIED
        elif request is RequestType.SET_DRIVE:
            if not wire.FREQUENCY_WORD_MIN <= values[0] <= wire.FREQUENCY_WORD_MAX:
                raise _RefusedError(Refusal.FREQUENCY_OUT_OF_RANGE)
            _check_phase(values[1])
            self._check_sound()
            self._dds.set_drive(time_s, values[0], values[1])
            self._flags |= Flags.CONFIGURED
        elif request is RequestType.SET_PHASE:
            _check_phase(values[0])
            self._check_sound()
            self._dds.set_phase(time_s, values[0])
        elif request is RequestType.OUTPUTS:
            self._switch(values[0], time_s)

    def _switch(self, on: int, time_s: float) -> None:
        if on > 1:
            raise _RefusedError(Refusal.BAD_VALUE)
        if on:
            self._check_sound()
        if on and not self._flags & Flags.CONFIGURED:
            raise _RefusedError(Refusal.NOT_CONFIGURED)
        self._dds.set_outputs(time_s, on=bool(on))
        self._flags &= ~(Flags.OUTPUTS_ON | Flags.HOST_SILENCE)
        if on:
            self._flags |= Flags.OUTPUTS_ON

    def _check_sound(self) -> None:
        if self._flags & Flags.INTERNAL_FAULT:
            raise _RefusedError(Refusal.INTERNAL_FAULT)

    def _reading(self, request: RequestType) -> tuple[int, ...]:
        """Return what a reply carries behind its flags."""
        if request is RequestType.IDENTIFY:
            return (
                wire.PROTOCOL_VERSION,
                *FIRMWARE_VERSION,
                wire.DDS_CLOCK_HZ,
                wire.FREQUENCY_WORD_MIN,
                wire.FREQUENCY_WORD_MAX,
                wire.PHASE_WORD_MIN,
                wire.PHASE_WORD_MAX,
                wire.DDS_FREQUENCY_BITS,
                wire.DDS_PHASE_BITS,
                wire.HOST_SILENCE_MS,
            )
        if request is RequestType.STATUS:
            return (
                self._reset_cause,
                self._faults,
                self._dds.a.frequency_word,
                self._dds.b.frequency_word,
                self._dds.a.phase_word,
                self._dds.b.phase_word,
                self._receiver.bad_frames,
                self._silence_trips,
            )
        return ()

    def _note_drive(self, time_s: float) -> None:
        drive = self._dds.drive
        if drive != self._drive:
            self._drive = drive
            self.drive_changes.append((time_s, drive))


def _check_phase(phase_word: int) -> None:
    if not wire.PHASE_WORD_MIN <= phase_word <= wire.PHASE_WORD_MAX:
        raise _RefusedError(Refusal.PHASE_OUT_OF_RANGE)
