"""usmbench replay --model, from the command line to its files."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from usmbench.cli.main import main
from usmbench.model.hammerstein import (
    HammersteinModel,
    LinearPart,
    OperatingPoint,
    StaticCurve,
)
from usmbench.model.model_file import write_model

CHECKER = Path(__file__).parents[4] / "shared" / "tools" / "check-contract"


@pytest.fixture
def model_file(tmp_path: Path) -> Path:
    """Return the file of a model whose curve is a straight line, 0.1 rad/s a degree."""
    curve = StaticCurve(np.array([-90.0, 90.0]), np.array([-9.0, 9.0]))
    point = OperatingPoint(41e3, 0.0, curve, (-90.0, 90.0), (None, None), 0.0)
    linear = LinearPart(np.array([-0.5]), np.array([0.5]), 0, 0.01)
    path = tmp_path / "model.yaml"
    write_model(path, HammersteinModel(linear, (point,), "fast"))
    return path


def run_file(tmp_path: Path, phase_deg: list[float], **columns: float) -> Path:
    """Write a run that the model explains exactly."""
    speed, state = [], 0.1 * phase_deg[0]
    for phase in phase_deg:
        state = 0.5 * state + 0.05 * phase
        speed.append(state)
    extra = "".join(f",{value}" for value in columns.values())
    rows = [f"{p},{s}{extra}" for p, s in zip(phase_deg, speed, strict=True)]
    path = tmp_path / "run.csv"
    path.write_text("\n".join([",".join(["phase_deg", "speed_rad_s", *columns]), *rows]) + "\n")
    return path


STEPS = [0.0] * 5 + [60.0] * 10 + [-30.0] * 10


def test_a_run_the_model_explains_fits_wholly(tmp_path: Path, model_file: Path) -> None:
    figures, plot = tmp_path / "replay.json", tmp_path / "replay.png"
    words = ["replay", str(run_file(tmp_path, STEPS)), "--model", str(model_file)]
    assert main([*words, "--json", str(figures), "--plot", str(plot)]) == 0
    content = json.loads(figures.read_text())
    assert content["n"] == 25
    assert content["rmse_rad_s"] < 1e-12
    assert content["fit_percent"] == pytest.approx(100.0)
    assert plot.read_bytes().startswith(b"\x89PNG")
    if CHECKER.is_file():
        subprocess.run(
            [sys.executable, CHECKER, "replay", figures], check=True, capture_output=True
        )


def test_json_to_standard_output_is_alone_there(
    tmp_path: Path, model_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = str(run_file(tmp_path, STEPS))
    assert main(["replay", run, "--model", str(model_file), "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["n"] == 25


def test_rows_outside_the_range_are_warned_of_and_not_scored(
    tmp_path: Path, model_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = str(run_file(tmp_path, [*STEPS, 120.0, 120.0]))
    assert main(["replay", run, "--model", str(model_file), "--json", "-"]) == 0
    captured = capsys.readouterr()
    content = json.loads(captured.out)
    assert (content["n"], content["n_outside"]) == (25, 2)
    assert content["rmse_rad_s"] < 1e-12
    assert "2 of 27 rows (first: row 25) are outside the model's phase range" in captured.err


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"frequency_hz": 42e3, "torque_nm": 0.0}, "every row lies outside the model's range"),
        ({"window_s": 0.02}, "windows of 20 ms, the model was identified on 10 ms"),
    ],
)
def test_a_run_of_another_kind_is_refused(
    tmp_path: Path,
    model_file: Path,
    capsys: pytest.CaptureFixture[str],
    columns: dict[str, float],
    message: str,
) -> None:
    run = str(run_file(tmp_path, STEPS, **columns))
    assert main(["replay", run, "--model", str(model_file)]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "one of the arguments --model --bench is required"),
        (["--model", "none.yaml"], "none.yaml: cannot be read"),
        (["--model", "M", "--bench", "simulated"], "not allowed with"),
        (["--model", "M", "--out", "x"], "--out is for --bench"),
        (["--bench", "simulated", "--json", "x"], "--json and --plot are for --model"),
        (["--bench", "simulated", "--plot", "x.png"], "--json and --plot are for --model"),
        (["--model", "M", "--plot", "x.nothing"], "give a .png, .svg or .pdf"),
    ],
)
def test_wrong_usage_is_one_line_and_status_2(
    tmp_path: Path,
    model_file: Path,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    message: str,
) -> None:
    words = [str(model_file) if word == "M" else word for word in words]
    assert main(["replay", str(run_file(tmp_path, STEPS)), *words]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 1
    assert message in errors[0]
