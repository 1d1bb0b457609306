"""A run's commands driven again through board, motor and encoder, in this process."""

from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from hil_sim.in_process import InProcessBench
from usmbench.cli import replay_on_bench
from usmbench.cli.bench_session import Bench
from usmbench.cli.main import main
from usmbench.cli.replay_on_bench import drive_again
from usmbench.instruments.generator import SignalGenerator
from usmbench.runs.reader import read_run
from usmbench.settings.bench import BenchSettings

BY_OPERATOR = {"load": "operator", "torque_nm": 0.1}
CONSTANT = {"load": "constant", "torque_nm": 0.1}


class WatchedOperator:
    """Sets the load on the simulated motor, and keeps which loads somebody was asked for."""

    def __init__(self, simulated: InProcessBench, generator: SignalGenerator):
        self.simulated, self.generator = simulated, generator
        self.asked: list[tuple[float, bool]] = []

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        assert not (ask and self.generator.outputs_on)
        self.asked.append((torque_nm, ask))
        self.simulated.set_load(torque_nm)

    def load_is_set(self) -> bool:
        return True


def run_of(folder: Path, torques_nm: list[float], plan: object) -> Path:
    """Write a run of 30 windows at each torque."""
    folder.mkdir()
    (folder / "run.yaml").write_text(f"format: usmbench-run/1\nplan: {plan}\n")
    rows = [f"60,5,{torque_nm}" for torque_nm in torques_nm for _ in range(30)]
    lines = [f"{0.01 * k:.2f},{row}" for k, row in enumerate(rows, 1)]
    head = "t_s,phase_deg,speed_rad_s,torque_nm"
    (folder / "windows.csv").write_text("\n".join([head, *lines, ""]))
    return folder


@pytest.mark.parametrize(
    ("torques_nm", "plan", "asked"),
    [
        ([0.0, 0.1], "null", True),
        ([0.1], "null", False),
        ([0.1], BY_OPERATOR, True),
        ([0.1], CONSTANT, False),
    ],
)
def test_the_operator_is_asked_for_loads_as_the_sweep_asked(
    tmp_path: Path, torques_nm: list[float], plan: Any, asked: bool
) -> None:
    settings, simulated = BenchSettings(), InProcessBench(3)
    generator = SignalGenerator(
        simulated.port,
        clock=simulated.clock,
        frequency_limits_hz=settings.generator.frequency_limits_hz,
        phase_limits_deg=settings.generator.phase_limits_deg,
    )
    operator = WatchedOperator(simulated, generator)
    bench = Bench(settings, generator, simulated.source, operator, simulated.clock)
    record = read_run(run_of(tmp_path / "run", torques_nm, plan))
    drive_again(bench, record, tmp_path / "again")
    assert operator.asked == [(torque_nm, asked) for torque_nm in torques_nm]
    again = read_run(tmp_path / "again")
    assert again.torque_nm is not None
    assert again.driven is not None
    assert list(dict.fromkeys(again.torque_nm[again.driven].tolist())) == torques_nm


def test_the_folder_is_named_however_the_replay_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run, again = run_of(tmp_path / "run", [0.1], "null"), tmp_path / "again"

    def stopped(bench: Bench, record: object, folder: Path, *, observer: object) -> None:
        folder.mkdir()
        (folder / "run.yaml").write_text("format: usmbench-run/1\n")
        raise KeyboardInterrupt

    bench = SimpleNamespace(settings=BenchSettings())
    monkeypatch.setattr(replay_on_bench, "open_bench", lambda bench_: nullcontext(bench))
    monkeypatch.setattr(replay_on_bench, "drive_again", stopped)
    assert main(["replay", str(run), "--bench", "simulated", "--out", str(again)]) == 130
    assert capsys.readouterr().out == f"{again}\n"


def test_a_folder_that_exists_is_refused_before_the_bench_opens(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = run_of(tmp_path / "run", [0.1], "null")
    opened: list[str] = []
    monkeypatch.setattr(replay_on_bench, "open_bench", opened.append)
    assert main(["replay", str(run), "--bench", "simulated", "--out", str(tmp_path)]) == 2
    assert "exists already" in capsys.readouterr().err
    assert opened == []
