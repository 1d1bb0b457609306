import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from usmbench.cli import simulated_bench
from usmbench.cli.main import main
from usmbench.cli.simulated_bench import start_testbed
from usmbench.errors import BenchError, InputError
from usmbench.runs.reader import read_run

PLAN = """\
format: usmbench-plan/1
name: short
frequency_hz: 41000
torque_nm: {torque}
{load}
passes:
  - phase_deg: [-90, -30, 0, 30, 90]
    direction: both
    repeats: {repeats}
dwell: {{windows: 20}}
"""


def plan_file(
    folder: Path, *, torque: str = "0", load: str = "load: constant", repeats: int = 1
) -> str:
    file = folder / "plan.yaml"
    file.write_text(PLAN.format(torque=torque, load=load, repeats=repeats))
    return str(file)


def sweep_process(folder: Path, *words: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "usmbench", "sweep", *words, "--bench", "simulated"]
    return subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def wait_for_rows(file: Path, rows: int, timeout_s: float = 60.0) -> None:
    deadline_s = time.monotonic() + timeout_s
    while not file.exists() or file.read_bytes().count(b"\n") < rows:
        assert time.monotonic() < deadline_s, "the sweep did not write its rows"
        time.sleep(0.02)


def children(pid: int) -> list[int]:
    listing = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii")
    return [int(word) for word in listing.split()]


def is_alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text(encoding="ascii").split(")")[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_the_testbed_answers_and_goes_when_it_is_not_needed() -> None:
    with start_testbed(["--lock-step", "--seed", "3"]) as testbed:
        assert Path(testbed.port).exists()
        assert testbed.daq_address.startswith("127.0.0.1:")
        testbed.set_load(0.1)
        with pytest.raises(BenchError, match="load"):
            testbed.set_load(-1.0)
    # Another program's terminal may have the port's name by now.
    host, _, port = testbed.daq_address.partition(":")
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection((host, int(port)), timeout=5.0)


def test_a_defect_that_the_index_stops_says_how_to_record_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["sweep", plan_file(tmp_path), "--bench", "simulated", "--out", str(tmp_path / "run")]
    assert main([*words, "--defect", "dead_direction"]) == 3
    said = capsys.readouterr().err
    assert "counts off" in said
    assert "start python -m hil_sim --lock-step, with the defect, and give --bench a file" in said
    assert said.count("\n") == 1


def test_a_testbed_that_refuses_its_arguments_says_why() -> None:
    with (
        pytest.raises(InputError, match=r"refuses.*no-such-option"),
        start_testbed(["--no-such-option"]),
    ):
        pass


def test_a_wrong_defect_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["sweep", plan_file(tmp_path), "--bench", "simulated", "--out", str(tmp_path / "run")]
    assert main([*words, "--defect", "worn=3"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "worn_contact" in said
    assert not (tmp_path / "run").exists()


def test_a_testbed_that_cannot_start_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.executable", "/bin/false")
    with pytest.raises(BenchError, match="ended with status 1"), start_testbed([]):
        pass


def test_a_testbed_that_cannot_start_holds_nobody_though_its_child_lives_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fifo, fake = tmp_path / "fifo", tmp_path / "python"
    os.mkfifo(fifo)
    fake.write_text(f"#!/bin/sh\n(read released < '{fifo}') &\n")
    fake.chmod(0o700)
    monkeypatch.setattr("sys.executable", str(fake))
    monkeypatch.setattr(simulated_bench, "START_TIMEOUT_S", 0.5)
    monkeypatch.setattr(simulated_bench, "STOP_TIMEOUT_S", 0.2)
    release = os.open(fifo, os.O_RDWR)
    in_the_end = threading.Timer(20.0, os.write, (release, b"\n"))
    in_the_end.start()
    with pytest.raises(BenchError, match="ended with status 0"), start_testbed([]):
        pass
    assert in_the_end.is_alive(), "who started it waited for the child's end"
    in_the_end.cancel()
    os.write(release, b"\n")
    for thread in threading.enumerate():
        if thread.name == "hil_sim output":
            thread.join(5.0)
    os.close(release)


def test_the_load_of_the_plan_reaches_the_motor(tmp_path: Path) -> None:
    speeds = []
    for torque in ("0", "0.2"):
        out = tmp_path / torque
        plan = plan_file(tmp_path, torque=torque)
        assert main(["sweep", plan, "--bench", "simulated", "--out", str(out)]) == 0
        pairs = read_run(out).pairs
        assert pairs is not None
        speeds.append(float(pairs.speed_rad_s[pairs.phase_deg == 30.0][0]))
    assert speeds[1] < speeds[0] - 0.5


def test_a_run_driven_again_gives_the_same_rows(tmp_path: Path) -> None:
    plan = plan_file(tmp_path)
    first, again = tmp_path / "first", tmp_path / "again"
    assert main(["sweep", plan, "--bench", "simulated", "--out", str(first)]) == 0
    assert main(["replay", str(first), "--bench", "simulated", "--out", str(again)]) == 0
    assert (first / "windows.csv").read_bytes() == (again / "windows.csv").read_bytes()


def test_ctrl_c_from_outside_ends_in_130_with_the_folder_closed(tmp_path: Path) -> None:
    process = sweep_process(tmp_path, plan_file(tmp_path, repeats=500), "--out", "run")
    wait_for_rows(tmp_path / "run" / "windows.csv", 50)
    (testbed,) = children(process.pid)
    process.send_signal(signal.SIGINT)
    said, complained = process.communicate(timeout=30)
    assert process.returncode == 130
    assert said == "run\n"
    assert complained == "usmbench: stopped by the user\n"
    assert read_run(tmp_path / "run").meta["exit"] == "interrupted"
    assert not is_alive(testbed)


def test_kill_9_loses_no_row_and_leaves_no_testbed_behind(tmp_path: Path) -> None:
    process = sweep_process(tmp_path, plan_file(tmp_path, repeats=500), "--out", "run")
    windows = tmp_path / "run" / "windows.csv"
    wait_for_rows(windows, 50)
    (testbed,) = children(process.pid)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate(timeout=30)
    record = read_run(tmp_path / "run")
    assert len(record.t_s) >= 49
    assert "exit" not in record.meta
    deadline_s = time.monotonic() + 20.0
    while is_alive(testbed):
        assert time.monotonic() < deadline_s, "the testbed outlives the process that started it"
        time.sleep(0.05)


def test_a_dead_testbed_is_status_3_and_named(tmp_path: Path) -> None:
    process = sweep_process(tmp_path, plan_file(tmp_path, repeats=500), "--out", "run")
    wait_for_rows(tmp_path / "run" / "windows.csv", 50)
    (testbed,) = children(process.pid)
    os.kill(testbed, signal.SIGKILL)
    _, complained = process.communicate(timeout=60)
    assert process.returncode == 3
    assert complained.count("\n") == 1
    assert "Traceback" not in complained
    assert str(read_run(tmp_path / "run").meta["exit"]).startswith("failed: ")


def test_the_address_is_json_for_programs() -> None:
    command = [sys.executable, "-m", "hil_sim", "--json", "--stdin-control", "--lock-step"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        address = json.loads(process.stdout.readline())
        assert set(address) >= {"port", "daq"}
        process.communicate(timeout=20)
    assert process.returncode == 0


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_whoever_reads_may_go_and_the_status_is_told_still(
    tmp_path: Path, how: signal.Signals
) -> None:
    process = sweep_process(tmp_path, plan_file(tmp_path, repeats=500), "--out", "run")
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    wait_for_rows(tmp_path / "run" / "windows.csv", 50)
    process.send_signal(how)
    assert process.wait(timeout=30) == 130
    assert "stopped by" in process.stderr.read()
    process.stderr.close()
    assert read_run(tmp_path / "run").meta["exit"] == "interrupted"
