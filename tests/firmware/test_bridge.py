"""The bridge by hand: a pseudo-terminal in real time, and commands it does not know."""

import json
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial

from hil_sim.gpsim_bridge import BUILD, GpsimBridge
from usmbench.errors import InputError, PortError
from usmbench.instruments.protocol._generated import BAUD, RequestType
from usmbench.instruments.protocol.frames import decode_frame, encode_frame

IDENTIFY = encode_frame(9, RequestType.IDENTIFY, b"")


@pytest.fixture
def terminal() -> Iterator[str]:
    command = [str(BUILD / "bridge"), str(BUILD / "generator.hex"), "--pty"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            event = json.loads(line)
            if "pty" in event:
                yield event["pty"]
                break
        process.kill()


def test_the_line_on_a_terminal(terminal: str) -> None:
    for _ in range(2):  # a host may come back
        with serial.Serial(terminal, BAUD, timeout=5.0) as port:
            port.write(b"\0" + IDENTIFY)
            reply = decode_frame(port.read_until(b"\0")[:-1])
            assert reply is not None
            assert (reply.sequence, len(reply.payload)) == (9, 24)


def test_another_baud_rate_is_not_understood(terminal: str) -> None:
    with serial.Serial(terminal, 57600, timeout=0.3) as port:
        port.write(b"\0" + IDENTIFY)
        time.sleep(0.05)
        answer = port.read(100)
    assert decode_frame(answer[:-1]) is None


def test_an_unknown_command_ends_the_bridge() -> None:
    with GpsimBridge() as bridge, pytest.raises(PortError, match="has ended"):
        bridge.command("run 10000", "dance")


def test_a_missing_build_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="make -C firmware"):
        GpsimBridge(tmp_path)
