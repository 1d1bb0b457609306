"""Opening ports and finding the board, over pseudo-terminals."""

import os
import pty
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from serial.tools import list_ports

from usmbench.errors import InputError, PortError
from usmbench.instruments import ports
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol._generated import ACK_BIT, RequestType
from usmbench.instruments.protocol.frames import Frame, FrameReader, encode_frame
from usmbench.settings.bench import GeneratorSettings

IDENTITY = bytes.fromhex("00 01 01 00 40787D01 B98D0600 9CE10600 00F8 0008 1C 0C E803")
SEARCH_TRIES = 10
Answer = Callable[[Frame], bytes]


def board(frame: Frame) -> bytes:
    payload = IDENTITY if frame.type == RequestType.IDENTIFY else b"\0"
    return encode_frame(frame.sequence, frame.type | ACK_BIT, payload)


def silent(frame: Frame) -> bytes:
    return b""


def babbler(frame: Frame) -> bytes:
    return b"$GPGGA,no\r\n" * 20


class Device:
    """What sits at the other end of a pseudo-terminal."""

    def __init__(self, answer: Answer):
        self.heard: list[Frame] = []
        self._answer = answer
        self._ours, theirs = pty.openpty()
        self.name = os.ttyname(theirs)
        self._theirs = theirs
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        reader = FrameReader()
        while True:
            try:
                data = os.read(self._ours, 1000)
            except OSError:
                return
            for frame in reader.feed(data):
                self.heard.append(frame)
                os.write(self._ours, self._answer(frame))

    def close(self) -> None:
        os.close(self._theirs)
        self._thread.join(5.0)
        os.close(self._ours)


@contextmanager
def devices(*answers: Answer) -> Iterator[list[Device]]:
    with ExitStack() as stack:
        found = [Device(answer) for answer in answers]
        for device in found:
            stack.callback(device.close)
        yield found


@pytest.fixture(autouse=True)
def _no_ports_of_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(list_ports, "comports", list)
    # The thread that answers for a board waits for its turn on a busy machine.
    monkeypatch.setattr(ports, "_SEARCH_TRIES", SEARCH_TRIES)


def test_the_board_is_found_among_other_instruments_by_identify_alone() -> None:
    with devices(silent, board, babbler) as (quiet, ours, noisy):
        assert ports.find_board([quiet.name, ours.name, noisy.name]) == ours.name
        assert len(quiet.heard) <= SEARCH_TRIES
        for device in (quiet, ours, noisy):
            assert {frame.type for frame in device.heard} == {RequestType.IDENTIFY}


def test_no_board_and_several_boards_are_wrong_input() -> None:
    with devices(silent) as (quiet,), pytest.raises(InputError, match="no board answers") as caught:
        ports.find_board([quiet.name, "/dev/does-not-exist"])
    assert "/dev/does-not-exist: cannot be opened" in str(caught.value)
    with (
        devices(board, board) as (one, other),
        pytest.raises(InputError, match=f"answer on {one.name} and {other.name}"),
    ):
        ports.find_board([one.name, other.name])
    with pytest.raises(InputError, match="This computer has no serial port"):
        ports.find_board()


def test_an_absent_port_is_named_beside_those_that_exist(monkeypatch: pytest.MonkeyPatch) -> None:
    class Listed:
        device = "/dev/ttyS7"

    monkeypatch.setattr(list_ports, "comports", lambda: [Listed])
    with pytest.raises(InputError, match=r"/dev/absent cannot .* plug .* here: /dev/ttyS7"):
        SignalGenerator.open(GeneratorSettings(port="/dev/absent"))


def test_something_that_is_no_serial_port(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"")
    with pytest.raises(InputError, match="cannot be opened"):
        ports.open_port(str(path))


def test_a_port_in_use_says_so() -> None:
    with devices(board) as (device,):
        port = ports.open_port(device.name)
        try:
            with pytest.raises(InputError, match="another program has this port open"):
                ports.open_port(device.name)
        finally:
            port.close()


def test_the_generator_opens_reopens_and_closes_its_port(monkeypatch: pytest.MonkeyPatch) -> None:
    with devices(board) as (device,):
        with SignalGenerator.open(GeneratorSettings(port=device.name)) as generator:
            assert generator.identity.firmware_major == 1
            generator.reconnect()
            monkeypatch.setattr(ports, "port_names", lambda: [device.name])
        kinds = [frame.type for frame in device.heard]
        assert kinds == [1, 4, 1, 4, 4]
        with SignalGenerator.open(GeneratorSettings(port="auto")):
            pass


def test_a_port_that_is_not_there_again_is_an_error_of_the_bench() -> None:
    with devices(board) as (device,):
        generator = SignalGenerator.open(GeneratorSettings(port=device.name))
        generator.close()
    with pytest.raises(PortError, match="1 s silence watchdog"):
        generator.reconnect()


def test_a_failed_opening_releases_the_port() -> None:
    def other_version(frame: Frame) -> bytes:
        return encode_frame(frame.sequence, frame.type | ACK_BIT, b"\0\x09")

    with devices(other_version) as (device,):
        with pytest.raises(InputError, match="version 9"):
            SignalGenerator.open(GeneratorSettings(port=device.name))
        ports.open_port(device.name).close()
