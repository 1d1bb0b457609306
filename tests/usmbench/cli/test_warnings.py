"""What a user ought to know of a run is said by every command that reads it."""

import json
from pathlib import Path

import numpy as np
import pytest

from usmbench.cli.main import main
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.model_file import write_model
from usmbench.model.simulate import simulate
from usmbench.runs.record import Record
from usmbench.runs.record_folder import write_record

JUDGING = ["identify RUN --out new.yaml", "replay RUN --model model.yaml"]
JUDGING += ["diagnose RUN --model model.yaml"]
READING = ["show RUN", "compare RUN RUN", "export RUN run.mat"]
META = {"format": "usmbench-run/1", "id": "x", "started": "2026-01-01T00:00:00+00:00"}


def motor() -> HammersteinModel:
    knots_deg = np.array([-90.0, -45.0, 0.0, 45.0, 90.0])
    curve = StaticCurve(knots_deg, np.array([-10.0, -8.0, 0.0, 8.0, 10.0]))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (-4.0, 4.0), 0.03)
    return HammersteinModel(LinearPart(np.array([-0.04]), np.array([0.96]), 0, 0.01), (point,), "x")


def closed_run(folder: Path) -> Path:
    """Write what the motor shows on its way up and down."""
    steps_deg = np.r_[np.arange(0, 90, 5), np.arange(90, -90, -5), np.arange(-90, 0, 5)]
    phase_deg = np.repeat(steps_deg.astype(np.float64), 12)
    noise = 0.03 * np.random.default_rng(0).standard_normal(phase_deg.size)
    speed_rad_s = simulate(motor(), phase_deg).speed_rad_s + noise
    window_s = np.full(phase_deg.size, 0.01)
    frequency_hz, torque_nm = np.full(phase_deg.size, 41_000.0), np.zeros(phase_deg.size)
    t_s = np.cumsum(window_s)
    record = Record("x", t_s, phase_deg, speed_rad_s, window_s, frequency_hz, torque_nm)
    write_record(folder, record, {**META, "exit": "completed"})
    return folder


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in a folder that holds the motor's model."""
    monkeypatch.chdir(tmp_path)
    write_model(Path("model.yaml"), motor())


@pytest.mark.parametrize("command", JUDGING)
def test_data_that_changed_after_the_run_was_closed_are_told(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    run = closed_run(Path("run"))
    words = [*command.replace("RUN", str(run)).split(), "--json", "-"]
    assert main(words) == 0
    assert "changed" not in capsys.readouterr().err
    windows = run / "windows.csv"
    windows.write_text("".join(windows.read_text().splitlines(keepends=True)[:-20]))
    assert main(words) == 0
    said = capsys.readouterr()
    assert "usmbench: warning: run: windows.csv changed after the run was closed" in said.err
    assert sum("changed after" in warning for warning in json.loads(said.out)["warnings"]) == 1
    if words[0] == "diagnose":
        assert main([*words, "--each"]) == 0
        said = capsys.readouterr()
        assert said.err.count("windows.csv changed after the run was closed") == 1


@pytest.mark.parametrize("command", READING)
def test_so_does_a_command_that_only_shows_them(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    run = closed_run(Path("run"))
    words = command.replace("RUN", str(run)).split()
    assert main(words) == 0
    assert capsys.readouterr().err == ""
    windows = run / "windows.csv"
    windows.write_text("".join(windows.read_text().splitlines(keepends=True)[:-20]))
    assert main(words) == 0
    said = capsys.readouterr().err
    assert said.startswith("usmbench: warning: run: windows.csv changed after the run was closed")


@pytest.mark.parametrize("command", JUDGING)
def test_a_name_in_a_warning_moves_no_cursor(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    run = closed_run(Path("a\x1b[31m\nrun"))
    (run / "pairs.csv").unlink()
    words = [str(run) if word == "RUN" else word for word in command.split()]
    assert main(words) == 0
    said = capsys.readouterr().err
    assert "usmbench: warning: a�[31m�run: pairs.csv changed after" in said
    assert "\x1b" not in said
