"""Every board under the same tests: the emulated one, the firmware in gpsim, a real one.

The image is built by `make -C firmware`; without it only the emulated board is tested. A real
board is tested where USMBENCH_REAL_BOARD_PORT names its port; expect some minutes, and let nothing
hang on its power stage.
"""

import os
import struct
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing
from typing import NamedTuple, Protocol

import pytest
import serial

from hil_sim.board import Board
from hil_sim.gpsim_board import GpsimBoard
from hil_sim.gpsim_bridge import BUILD, GpsimBridge
from hil_sim.line import BYTE_S
from hil_sim.testbed import BoardMachine
from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import RequestType, ResetCause
from usmbench.instruments.protocol.frames import decode_frame, encode_frame

REAL_PORT = os.environ.get("USMBENCH_REAL_BOARD_PORT")
IMAGE_IS_BUILT = (BUILD / "bridge").is_file() and (BUILD / "generator.hex").is_file()
SIMULATED = ["emulated", *(["gpsim"] if IMAGE_IS_BUILT else [])]
collect_ignore = [] if IMAGE_IS_BUILT else ["test_image.py", "test_both_boards.py"]
EVERY_BOARD = [*SIMULATED, *(["real"] if REAL_PORT else [])]


def pytest_report_header() -> list[str]:
    return [] if IMAGE_IS_BUILT else ["firmware: not built, only the emulated board is tested"]


class Reply(NamedTuple):
    sequence: int
    type: int
    payload: bytes

    @property
    def acknowledged(self) -> bool:
        return not self.type & 0x40

    @property
    def reason(self) -> int:
        assert not self.acknowledged
        return self.payload[0]

    @property
    def flags(self) -> int:
        return self.payload[0] if self.acknowledged else self.payload[1]


class Status(NamedTuple):
    flags: int
    reset_cause: int
    faults: int
    frequency_word_a: int
    frequency_word_b: int
    phase_word_a: int
    phase_word_b: int
    bad_frames: int
    silence_trips: int


class Line(Protocol):
    """A host's end of the line to one board."""

    def send(self, data: bytes) -> None: ...

    def wait(self, duration_s: float) -> None: ...

    def received(self) -> list[bytes]: ...


class MachineLine:
    """The line to a simulated board, and what the board drives."""

    def __init__(self, board: BoardMachine, words: list[tuple[str, int]]):
        self.board = board
        self.words = words
        self.now_s = 0.0

    def send(self, data: bytes) -> None:
        for byte in data:
            self.now_s += BYTE_S
            self.board.advance(self.now_s)
            self.board.receive(byte, self.now_s)

    def wait(self, duration_s: float) -> None:
        self.now_s += duration_s
        self.board.advance(self.now_s)

    def received(self) -> list[bytes]:
        frames = [frame for _, frame in self.board.replies]
        # A host that waits for its answer speaks when the answer is over.
        ends_s = [start_s + len(frame) * BYTE_S for start_s, frame in self.board.replies]
        self.now_s = max([self.now_s, *ends_s])
        self.board.replies.clear()
        return frames

    def reset(self, cause: ResetCause) -> None:
        self.board.reset(self.now_s, cause)
        self.wait(0.001)

    def drives(self) -> bool:
        changes = self.board.drive_changes
        return bool(changes) and changes[-1][1].amplitude_a > 0.0


class PortLine:
    """The line to a real board."""

    # For the next byte, the host's and an adapter's own delays included: of an answer that is
    # expected or has begun; and after a whole one, where another may follow.
    ANSWER_TIMEOUT_S, GAP_S = 0.5, 0.1

    def __init__(self, port: serial.Serial):
        self.port = port

    def send(self, data: bytes) -> None:
        self.port.write(data)
        self.port.flush()

    def wait(self, duration_s: float) -> None:
        time.sleep(duration_s)

    def received(self) -> list[bytes]:
        frames, frame = [], b""
        self.port.timeout = self.ANSWER_TIMEOUT_S
        while byte := self.port.read(1):
            frame += byte
            self.port.timeout = self.ANSWER_TIMEOUT_S
            if byte == b"\0":
                frames.append(frame)
                frame = b""
                self.port.timeout = self.GAP_S
        assert frame == b""
        return frames


class Host:
    """Asks a board and reads its answers."""

    def __init__(self, line: Line):
        self.line = line
        self.sequence = 0

    def frame(self, kind: int, *fields: int, sequence: int | None = None) -> bytes:
        """Encode a request with its fields, under the next sequence number."""
        if sequence is None:
            self.sequence = sequence = (self.sequence + 1) % 256
        layout = wire.REQUEST_LAYOUTS[RequestType(kind)]
        payload = struct.pack("<" + "".join(code for _, code in layout), *fields)
        return encode_frame(sequence, kind, payload)

    def exchange(self, data: bytes) -> list[Reply]:
        self.line.send(data)
        self.line.wait(0.001)
        replies = []
        for encoded in self.line.received():
            assert encoded.endswith(b"\0")
            frame = decode_frame(encoded[:-1])
            assert frame is not None
            replies.append(Reply(*frame))
        return replies

    def ask_raw(self, data: bytes) -> Reply:
        (reply,) = self.exchange(data)
        return reply

    def ask(self, kind: RequestType, *fields: int) -> Reply:
        reply = self.ask_raw(self.frame(kind, *fields))
        assert reply.sequence == self.sequence
        assert reply.type & 0x3F == kind
        return reply

    def status(self) -> Status:
        reply = self.ask(RequestType.STATUS)
        layout = wire.REPLY_LAYOUTS[RequestType.STATUS]
        return Status(*struct.unpack("<" + "".join(code for _, code in layout), reply.payload))

    def start(self, frequency_word: int = 440_000, phase_word: int = 512) -> None:
        """Identify, configure, switch on."""
        assert self.ask(RequestType.IDENTIFY).acknowledged
        assert self.ask(RequestType.SET_DRIVE, frequency_word, phase_word).acknowledged
        assert self.ask(RequestType.OUTPUTS, 1).acknowledged


class BenchHost(Host):
    """A host of a simulated board, which also sees what the board drives and can reset it."""

    line: MachineLine

    def new_words(self) -> list[tuple[str, int]]:
        words = self.line.words.copy()
        self.line.words.clear()
        return words


def open_simulated(kind: str, stack: ExitStack) -> BenchHost:
    words: list[tuple[str, int]] = []

    def log(_time_s: float, chips: str, word: int) -> None:
        words.append((chips, word))

    if kind == "emulated":
        host = BenchHost(MachineLine(Board(spi_log=log), words))
    else:
        board = GpsimBoard(stack.enter_context(GpsimBridge()), spi_log=log)
        stack.callback(_assert_sound, board)
        host = BenchHost(MachineLine(board, words))
    host.line.wait(0.001)
    return host


def _assert_sound(board: GpsimBoard) -> None:
    assert board.errors == []


@pytest.fixture(params=SIMULATED)
def bench_host(request: pytest.FixtureRequest) -> Iterator[BenchHost]:
    """A simulated board, fresh from power-on."""
    with ExitStack() as stack:
        yield open_simulated(request.param, stack)


@pytest.fixture(params=EVERY_BOARD)
def host(request: pytest.FixtureRequest) -> Iterator[Host]:
    """Any board; a real one is not fresh, but its outputs are off."""
    with ExitStack() as stack:
        if request.param != "real":
            yield open_simulated(request.param, stack)
            return
        port = stack.enter_context(closing(serial.Serial(REAL_PORT, wire.BAUD)))
        real = Host(PortLine(port))
        real.exchange(b"\0")
        real.ask(RequestType.OUTPUTS, 0)
        yield real
        real.exchange(b"\0")
        real.ask(RequestType.OUTPUTS, 0)


class ImageHost(BenchHost):
    """A host of the firmware in gpsim, which can also disturb its processor."""

    line: MachineLine

    @property
    def image(self) -> GpsimBoard:
        assert isinstance(self.line.board, GpsimBoard)
        return self.line.board

    def disturb(self, *commands: str) -> None:
        """Give the bridge commands; then let the firmware run on to the host's time."""
        self.image.disturb(*commands)
        self.line.wait(0.001)


@pytest.fixture
def image_host() -> Iterator[ImageHost]:
    """The firmware in gpsim, fresh from power-on."""
    with ExitStack() as stack:
        host = open_simulated("gpsim", stack)
        yield ImageHost(host.line)


@pytest.fixture
def both_boards() -> Iterator[tuple[BenchHost, BenchHost]]:
    """The emulated board and the firmware in gpsim, side by side."""
    with ExitStack() as stack:
        yield open_simulated("emulated", stack), open_simulated("gpsim", stack)
