"""One request at a time over the serial port: deadlines, resends, stale replies."""

from collections.abc import Callable
from contextlib import suppress
from typing import Final, TextIO

from usmbench.errors import BoardError, BoardRefusedError, PortError
from usmbench.instruments.frame_log import FrameLog
from usmbench.instruments.protocol._generated import (
    ACK_BIT,
    REFUSAL_BITS,
    Refusal,
    RequestType,
)
from usmbench.instruments.protocol.frames import (
    DELIMITER_BYTE,
    Frame,
    FrameReader,
    encode_frame,
    encoded_size,
)
from usmbench.instruments.protocol.messages import pack_request, unpack_refusal
from usmbench.instruments.serial_port import SerialPort

REPLY_TIMEOUT_S: Final = 0.05
TRIES: Final = 5
DRIVE_STOPS: Final = "the drive stops by the board's own 1 s silence watchdog"

_SHORTEST_REPLY: Final = encoded_size(1)

_MENDS: Final = {
    Refusal.UNKNOWN_COMMAND: "flash the firmware that belongs to this usmbench",
    Refusal.WRONG_LENGTH: "flash the firmware that belongs to this usmbench",
    Refusal.FREQUENCY_OUT_OF_RANGE: "stay within the board's limits",
    Refusal.PHASE_OUT_OF_RANGE: "stay within the board's limits",
    Refusal.NOT_CONFIGURED: "set the drive before switching the outputs on",
    Refusal.NOT_IDENTIFIED: "the board has restarted: connect to it anew",
    Refusal.BAD_VALUE: "flash the firmware that belongs to this usmbench",
    Refusal.INTERNAL_FAULT: "read its status, then switch the board off and on",
}


class BoardLink:
    """Asks the board and returns its answer, or says why there is none.

    A lost or spoilt frame is sent again under the same sequence number, so the board acts once.
    A reply to anything but the request under way is passed over, whenever it comes: an exchange
    may be broken off at any instant (Ctrl-C) and the next one is sound.

    Parameters
    ----------
    port
        The open serial port.
    clock
        Seconds, on the port's own time.
    frame_log
        Text stream that takes every frame, or None.
    tries
        How often a request is sent before the board counts as silent.
    reply_timeout_s
        Time a reply may take before the request is sent again.
    """

    def __init__(
        self,
        port: SerialPort,
        *,
        clock: Callable[[], float],
        frame_log: TextIO | None = None,
        tries: int = TRIES,
        reply_timeout_s: float = REPLY_TIMEOUT_S,
    ):
        self._port = port
        self._clock = clock
        self._log = None if frame_log is None else FrameLog(frame_log, clock)
        self._tries = tries
        self._reply_timeout_s = reply_timeout_s
        self._reader = FrameReader()
        self._sequence = 0
        self._in_step = False

    @property
    def port_name(self) -> str:
        """Get the port's name, for messages."""
        return self._port.name or "serial port"

    def request(self, kind: RequestType, *values: int) -> bytes:
        """Send a request and wait for its acknowledgement.

        Parameters
        ----------
        kind
            Which request.
        *values
            Its fields, in order.

        Returns
        -------
        bytes
            Payload of the acknowledgement.

        Raises
        ------
        usmbench.errors.BoardRefusedError
            The board refused it; `reason` names the refusal.
        usmbench.errors.BoardError
            No answer after all tries.
        usmbench.errors.PortError
            The port has gone.
        """
        frame = self._next_frame(kind, pack_request(kind, *values))
        encoded = encode_frame(*frame)
        resend = DELIMITER_BYTE + encoded
        data = encoded if self._in_step else resend
        self._in_step = False
        for _ in range(self._tries):
            reply = self._exchange(frame, data)
            if reply is not None:
                self._in_step = True
                return _accepted(kind, reply)
            data = resend
        raise BoardError(
            f"the board on {self.port_name} did not answer {kind.name.lower()} in {self._tries} "
            f"tries of {self._reply_timeout_s:g} s: check its power and cable; {DRIVE_STOPS}"
        )

    def replace_port(self, port: SerialPort) -> None:
        """Go on over another port; the old one is closed.

        Parameters
        ----------
        port
            The open serial port.
        """
        self.close()
        self._port = port
        self._in_step = False

    def close(self) -> None:
        """Release the port, whether or not it is still there."""
        with suppress(OSError):
            self._port.close()

    def _next_frame(self, kind: RequestType, payload: bytes) -> Frame:
        """Take the next sequence number; forget what an exchange broken off has left."""
        if not self._in_step:
            self._reader.clear()
        self._sequence = (self._sequence + 1) & 0xFF
        return Frame(self._sequence, kind, payload)

    def _exchange(self, frame: Frame, data: bytes) -> Frame | None:
        """Send once and wait for the reply until the deadline."""
        deadline_s = self._clock() + self._reply_timeout_s
        self._write(data)
        if self._log is not None:
            self._log.sent(data, frame)
        wanted = (frame.type | ACK_BIT, frame.type | REFUSAL_BITS)
        size, remaining_s = _SHORTEST_REPLY, self._reply_timeout_s
        while remaining_s > 0.0:
            received = self._read(size, remaining_s)
            if not received:
                return None
            for reply in self._frames(received):
                if reply.sequence == frame.sequence and reply.type in wanted:
                    return reply
            size, remaining_s = 1, deadline_s - self._clock()
        return None

    def _write(self, data: bytes) -> None:
        try:
            self._port.write(data)
        except OSError as error:
            raise self._port_error(error) from error

    def _read(self, size: int, timeout_s: float) -> bytes:
        """Return what is there, and at least `size` bytes unless the time is over."""
        try:
            # Every assignment reconfigures a real port, so the usual case makes none.
            if self._port.timeout != timeout_s:
                self._port.timeout = timeout_s
            return self._port.read(max(size, self._port.in_waiting))
        except OSError as error:
            raise self._port_error(error) from error

    def _frames(self, data: bytes) -> list[Frame]:
        n_bad = self._reader.n_bad
        frames = self._reader.feed(data)
        if self._log is not None:
            self._log.received(data, frames, self._reader.n_bad - n_bad)
        return frames

    def _port_error(self, error: OSError) -> PortError:
        return PortError(
            f"{self.port_name} has gone ({error}): check the cable and the adapter; {DRIVE_STOPS}"
        )


def _accepted(kind: RequestType, reply: Frame) -> bytes:
    """Return the payload of an acknowledgement; raise a refusal."""
    if reply.type == kind | ACK_BIT:
        return reply.payload
    reason, _ = unpack_refusal(reply.payload)
    name = reason.name.lower()
    raise BoardRefusedError(
        f"the board refused {kind.name.lower()} ({name}): {_MENDS[reason]}", reason=name
    )
