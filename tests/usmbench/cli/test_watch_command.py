"""The command in a process of its own, beside a sweep and without one."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.request import Request, urlopen

import pytest

from usmbench.cli.main import main
from usmbench.runs.meta import read_meta
from usmbench.runs.reader import read_run

PLAN = """
format: usmbench-plan/1
name: long
frequency_hz: 41000
passes: [{phase_deg: {from: -90, to: 90, step: 1}, direction: both, repeats: 5}]
"""
USMBENCH = [sys.executable, "-m", "usmbench"]


@contextmanager
def watching(folder: Path) -> Iterator[tuple["subprocess.Popen[str]", str, str]]:
    command = [*USMBENCH, "watch", str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        said = re.match(r"page   (http://127\.0\.0\.1:\d+)/#(\S+)", process.stdout.readline())
        assert said is not None
        assert said[2] in process.stdout.readline()
        assert "a sweep goes on" in process.stdout.readline()
        try:
            yield process, said[1], said[2]
        finally:
            process.kill()


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    file = tmp_path / "long.yaml"
    file.write_text(PLAN)
    return file


def press_stop(address: str, token: str) -> int:
    request = Request(f"{address}/stop", b"{}", {"X-Usmbench-Token": token})
    with urlopen(request, timeout=10.0) as reply:
        return int(reply.status)


def test_killing_it_never_touches_the_sweep_and_its_button_stops_it(
    plan: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "run"
    command = [*USMBENCH, "sweep", str(plan), "--bench", "simulated", "--out", str(folder)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as sweep:
        while not (folder / "pairs.csv").exists():
            assert sweep.poll() is None
        with watching(folder) as (watch, _, _):
            watch.kill()
            watch.wait(10.0)
        assert sweep.poll() is None
        with watching(folder) as (_, address, token):
            assert press_stop(address, token) == 202
            _, says = sweep.communicate(timeout=60.0)
    assert sweep.returncode == 130
    assert "stop request" in says
    assert read_meta(folder)["exit"] == "interrupted"
    assert not (folder / "stop-request").exists()
    assert len(read_run(folder).t_s) > 100


def test_ctrl_c_ends_the_page_with_status_0(tmp_path: Path) -> None:
    (tmp_path / "bare.csv").write_text("phase_deg,speed_rad_s\n0,0\n90,9\n")
    with watching(tmp_path / "bare.csv") as (watch, address, _):
        with urlopen(f"{address}/state", timeout=10.0) as reply:
            assert reply.status == 200
        os.kill(watch.pid, signal.SIGINT)
        assert watch.wait(10.0) == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "nowhere"),
        (["bare.csv", "--port", "70000"], "--port"),
        (["bare.csv", "--model", "absent.yaml"], "absent.yaml"),
    ],
)
def test_bad_input_is_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    words: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bare.csv").write_text("phase_deg,speed_rad_s\n0,0\n")
    assert main(["watch", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert words in error
