"""`python -m hil_sim` as a client starts it."""

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
import serial

from hil_sim.__main__ import build_plant, main
from hil_sim.control import answer
from hil_sim.frame_receiver import build_frame
from hil_sim.plant import MotorPlant
from hil_sim.signals import Drive
from hil_sim.testbed import FaultablePlant, Testbed


@contextmanager
def started(*arguments: str) -> "Iterator[subprocess.Popen[str]]":
    command = [sys.executable, "-m", "hil_sim", *arguments]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


def said(process: "subprocess.Popen[str]") -> str:
    assert process.stdout is not None
    return process.stdout.readline().strip()


def test_it_says_where_it_is_and_ends_when_its_parent_does() -> None:
    with started("--json", "--stdin-control", "--lock-step", "--load", "0.1") as process:
        places = json.loads(said(process))
        assert places["daq"].startswith("127.0.0.1:")
        assert process.stdin is not None
        # Held open, the port's number is nobody else's when the testbed has gone.
        with serial.Serial(places["port"], 115200, timeout=5.0) as port:
            port.write(build_frame(b"\x01\x06"))
            assert len(port.read(8)) == 8
            process.stdin.write('{"load_nm": 0.2}\n{"load_nm": -1}\n')
            process.stdin.flush()
            assert json.loads(said(process)) == {"ok": True, "time_s": 0.0}
            assert json.loads(said(process))["ok"] is False
            process.stdin.close()
            assert process.wait(10) == 0
            with pytest.raises(OSError, match="failed"):
                port.write(b"anybody there?")
        assert process.stderr is not None
        assert process.stderr.read() == ""


def test_control_from_a_standard_input_that_is_closed_is_refused() -> None:
    command = ["sh", "-c", 'exec "$0" -m hil_sim --stdin-control <&-', sys.executable]
    done = subprocess.run(command, capture_output=True, text=True, timeout=20)
    assert done.returncode == 2
    assert done.stderr.startswith("hil_sim: --stdin-control needs standard input, which is closed")
    assert done.stderr.count("\n") == 1


def turned(plant: FaultablePlant) -> float:
    """Counts after half a second of drive."""
    plant.drive(0.0, Drive(41_000.0, 90.0, 1.0, 1.0))
    return float(plant.sample(500, 1000.0).position[-1])


def test_a_defect_reaches_the_motor() -> None:
    assert turned(build_plant(["worn_contact=50"], 1)) < 0.9 * turned(build_plant([], 1))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_without_a_word(number: signal.Signals) -> None:
    with started() as process:
        assert said(process).startswith("serial port: /dev/")
        assert said(process).startswith("DAQ address: 127.0.0.1:")
        process.send_signal(number)
        assert process.wait(10) == 0
        assert process.stderr is not None
        assert process.stderr.read() == ""


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--fault", "earthquake@1"], "no such kind"),
        (["--fault-file", "absent.yaml"], "cannot be read"),
        (["--load", "-1"], "load torque"),
        (["--load", "nan"], "load torque"),
        (["--seed", "-1"], "seed"),
        (["--defect", "gremlin"], "no such mechanism"),
        (["--defect", "command_queue=long"], "give a number in ms"),
        (["--fault-file", "a\x1b[31m.yaml"], "a\ufffd[31m.yaml"),
        (["--nonsense"], "unrecognized arguments: --nonsense (see `python -m hil_sim --help`)"),
        (["--board", "wooden"], "invalid choice: 'wooden'"),
    ],
)
def test_a_wrong_argument_is_one_line_and_status_2(
    arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    message = capsys.readouterr().err
    assert says in message
    assert message.count("\n") == 1


@pytest.mark.parametrize(
    "line", [b"", b"[1]", b"\xff", b'{"load_nm": "1"}', b'{"load_nm": true}', b'{"weight": 1}']
)
def test_what_the_control_does_not_understand_is_answered(line: bytes) -> None:
    reply = answer(Testbed(MotorPlant()), line)
    assert reply["ok"] is False
    assert reply["error"]


def test_an_empty_object_asks_for_the_time() -> None:
    testbed = Testbed(MotorPlant())
    testbed.idle(0.2)
    assert answer(testbed, b"{}") == {"ok": True, "time_s": pytest.approx(0.2)}
