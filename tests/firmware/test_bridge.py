"""The bridge by hand: a pseudo-terminal in real time, and commands it does not know."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
import serial

from hil_sim.gpsim_bridge import BUILD, CYCLES_PER_SECOND, GpsimBridge
from usmbench.errors import InputError, PortError
from usmbench.instruments.protocol._generated import BAUD, RequestType
from usmbench.instruments.protocol.frames import decode_frame, encode_frame

IDENTIFY = encode_frame(9, RequestType.IDENTIFY, b"")


class Terminal(NamedTuple):
    port: str
    process: "subprocess.Popen[bytes]"
    began_s: float


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    command = [str(BUILD / "bridge"), str(BUILD / "generator.hex"), "--pty"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            event = json.loads(line)
            if "pty" in event:
                yield Terminal(event["pty"], process, time.monotonic())
                break
        process.kill()


def test_the_line_on_a_terminal(terminal: Terminal) -> None:
    for _ in range(2):  # a host may come back
        with serial.Serial(terminal.port, BAUD, timeout=5.0) as port:
            port.write(b"\0" + IDENTIFY)
            reply = decode_frame(port.read_until(b"\0")[:-1])
            assert reply is not None
            assert (reply.sequence, len(reply.payload)) == (9, 24)


def test_time_in_which_it_was_stopped_is_left_out(terminal: Terminal) -> None:
    stopped_s = 1.0
    terminal.process.send_signal(signal.SIGSTOP)
    time.sleep(stopped_s)
    terminal.process.send_signal(signal.SIGCONT)
    with serial.Serial(terminal.port, BAUD, timeout=5.0) as port:
        port.write(b"\0" + IDENTIFY)
        port.read_until(b"\0")
    assert terminal.process.stdout is not None
    event = json.loads(terminal.process.stdout.readline())
    reached_s = event["cycle"] / CYCLES_PER_SECOND
    assert reached_s < time.monotonic() - terminal.began_s - stopped_s + 0.05


def test_the_conformance_suite_takes_a_port_by_hand(terminal: Terminal) -> None:
    suite = Path(__file__).resolve().parents[1] / "conformance"
    done = subprocess.run(
        [sys.executable, "-m", "pytest", suite, "-q", "-k", "real and identify_tells"],
        env={**os.environ, "USMBENCH_REAL_BOARD_PORT": terminal.port},
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout


def test_another_baud_rate_is_not_understood(terminal: Terminal) -> None:
    with serial.Serial(terminal.port, 57600, timeout=0.3) as port:
        port.write(b"\0" + IDENTIFY)
        time.sleep(0.05)
        answer = port.read(100)
    assert decode_frame(answer[:-1]) is None


def test_an_unknown_command_ends_the_bridge() -> None:
    with GpsimBridge() as bridge, pytest.raises(PortError, match="has ended"):
        bridge.command("run 10000", "dance")


CTRL_C = """\
import os, signal, time
from hil_sim.gpsim_bridge import GpsimBridge

with GpsimBridge() as bridge:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.killpg(0, signal.SIGINT)
    time.sleep(0.3)
    bridge.command("run 10000")
"""


def test_ctrl_c_in_a_terminal_is_for_the_testbed_alone() -> None:
    command = [sys.executable, "-c", CTRL_C]
    done = subprocess.run(command, start_new_session=True, stderr=subprocess.PIPE, timeout=60)
    assert (done.returncode, done.stderr) == (0, b"")


def test_a_missing_build_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="make -C firmware"):
        GpsimBridge(tmp_path)
