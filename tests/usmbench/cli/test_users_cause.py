"""What a user's cause does wrong is one line and exit status 2, whichever command meets it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hil_sim.__main__ import main as hil_sim_main
from known_motor import measured
from usmbench.cli.main import main
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.model_file import write_model

BRAKED = {
    "name": "brake_left_on",
    "form": "",
    "parameters": {"slowed_by": 0.2, "until_s": 1.0},
}
DOES = "        braked = context"


def motor() -> HammersteinModel:
    curve = StaticCurve(np.array([-90.0, 0.0, 90.0]), np.array([-10.0, 0.0, 10.0]))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (-4.0, 4.0), 0.03)
    return HammersteinModel(LinearPart(np.array([-0.04]), np.array([0.96]), 0, 0.01), (point,), "x")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A run, a model of its motor, and one that is extended by the user's cause."""
    record = measured(5, n=600)
    columns = np.column_stack([record.t_s, record.phase_deg, record.speed_rad_s])
    header = "t_s,phase_deg,speed_rad_s"
    np.savetxt(tmp_path / "run.csv", columns, delimiter=",", header=header, comments="")
    write_model(tmp_path / "model.yaml", motor())
    write_model(tmp_path / "extended.yaml", replace(motor(), effects=(BRAKED,)))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def spoil(file: Path, statement: str) -> None:
    text = file.read_text("utf-8")
    assert text.count(DOES) == 1
    file.write_text(text.replace(DOES, f"        {statement}\n{DOES}"), "utf-8")


@pytest.mark.parametrize(
    "words",
    [
        "identify run.csv --out new.yaml",
        "diagnose run.csv --model model.yaml",
        "diagnose run.csv --model model.yaml --each",
        "diagnose run.csv --model extended.yaml",
        "replay run.csv --model extended.yaml",
    ],
)
@pytest.mark.usefixtures("folder")
def test_a_cause_that_fails_is_told_by_every_command(
    users_cause: Path, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    spoil(users_cause, "raise KeyError('oops')")
    assert main(words.split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("usmbench: entry point brake_left_on: the cause brake_left_on (my_bench")
    assert "apply raised KeyError: 'oops'; mend it" in line


@pytest.mark.parametrize(
    "words", ["diagnose run.csv --model model.yaml", "replay run.csv --model extended.yaml"]
)
@pytest.mark.usefixtures("folder")
def test_a_cause_that_fails_on_the_run_alone_is_told(
    users_cause: Path, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    spoil(users_cause, "assert context.n > 1000, 'too short'")
    assert main(words.split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("usmbench: the cause brake_left_on (my_bench.brake_left_on, line 22): ")
    assert "apply raised AssertionError: too short; mend it" in line


@pytest.mark.usefixtures("folder")
def test_the_simulated_motor_says_what_its_cause_fails_at_before_it_turns(
    users_cause: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spoil(users_cause, "assert context.n > 1000, 'too short'")
    assert hil_sim_main(["--model", "extended.yaml"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("hil_sim: the cause brake_left_on (my_bench.brake_left_on, line 22): ")
