"""usmbench runs: the list, its conditions, its check sums."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from usmbench.cli.main import main
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.model_file import write_model
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import WindowRow

ROW = WindowRow(0.01, 90.0, 9.0, 41e3, 0.0, 0.09, 0.01, 0, 1, 9.0, 1)


def make_run(folder: Path, plan: str, outcome: str | None = "completed") -> Path:
    meta = {"plan": {"name": plan, "frequency_hz": [41e3, 41.5e3], "torque_nm": [0.0, 0.1]}}
    writer = RunWriter.create(folder, meta, temperature=False, raw=False)
    writer.window(ROW)
    if outcome is not None:
        writer.close(outcome)
    return folder


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    make_run(tmp_path / "one", "phase-sweep")
    make_run(tmp_path / "two", "telegraph", "interrupted")
    return tmp_path


def said_of(capsys: pytest.CaptureFixture[str], *words: str, status: int = 0) -> list[str]:
    assert main(["runs", *words]) == status
    return capsys.readouterr().out.splitlines()


def test_the_list_says_when_what_and_how_it_ended(
    runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = said_of(capsys, str(runs))
    assert lines[0].split() == ["run", "started", "plan", "points", "exit", "fit"]
    assert lines[1].startswith("one")
    assert "41/41.5 kHz, 0/0.1 N·m  completed    -" in lines[1]
    assert "telegraph" in lines[2]
    assert lines[-1] == "2 runs"


def test_the_json_names_a_folder_whose_name_is_no_utf_8(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = os.fsdecode(b"b\xffd")
    make_run(tmp_path / name, "telegraph")
    file = tmp_path / "runs.json"
    said_of(capsys, str(tmp_path), "--json", str(file))
    printed = "\n".join(said_of(capsys, str(tmp_path), "--json", "-"))
    for text in (file.read_text(encoding="utf-8"), printed):
        assert [Path(run["folder"]).name for run in json.loads(text)["runs"]] == [name]


def test_a_condition_leaves_the_others_out(runs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert said_of(capsys, str(runs), "--find", "exit=interrupted")[-1] == "1 run"


@pytest.mark.parametrize("place", [".", "elsewhere"])
def test_a_model_beside_the_runs_or_us_gives_its_fit(
    place: str, runs: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (runs / "elsewhere").mkdir()
    monkeypatch.chdir(runs / "elsewhere")
    curve = StaticCurve(np.array([-90.0, 90.0]), np.array([-9.0, 9.0]))
    point = OperatingPoint(41e3, 0.0, curve, (-90.0, 90.0), (None, None), 0.0)
    linear = LinearPart(np.array([-0.5]), np.array([0.5]), 0, 0.01)
    fitted_on = ({"name": f"../{runs.name}/one"},)
    residual = {"rmse_free_run_rad_s": 0.0123}
    model = HammersteinModel(linear, (point,), "fast", fitted_on, residual)
    write_model(runs / place / "model.yaml", model)
    (runs / "notes.yaml").write_text("a: [unclosed\n")
    one, two = json.loads("\n".join(said_of(capsys, str(runs), "--json", "-")))["runs"]
    assert (one["rmse_free_run_rad_s"], two["rmse_free_run_rad_s"]) == (0.0123, None)
    assert "0.0123 rad/s" in said_of(capsys, str(runs))[1]


def test_check_names_the_run_whose_data_changed(
    runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_run(runs / "three", "phase-sweep", None)
    words = ["runs", str(runs), "--check"]
    assert main(words) == 0
    assert "unchanged since it was written: 2 runs of 3" in capsys.readouterr().out
    with (runs / "two" / "windows.csv").open("a") as file:
        file.write("0.02,90,9,41000,0,0.18,0.01,0,1,9,1\n")
    assert main([*words, "--json", str(runs / "list.json")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "two: windows.csv changed after the run was closed, in 1 of 3 runs" in said
    listed = json.loads((runs / "list.json").read_text())["runs"]
    assert [run["changed"] for run in listed] == [[], ["windows.csv"], []]


@pytest.mark.parametrize(
    ("written", "why"),
    [
        ("format: [", "two/run.yaml"),
        ("format: usmbench-run/1\nexit: completed\nsha256: 4\n", "sha256 must map file names"),
    ],
)
def test_a_run_that_cannot_be_checked_is_named_and_the_check_does_not_pass(
    written: str, why: str, runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (runs / "two" / "run.yaml").write_text(written)
    assert main(["runs", str(runs)]) == 0
    capsys.readouterr()
    words = ["runs", str(runs), "--check", "--json", str(runs / "list.json")]
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert "unchanged" not in out
    warning, error = err.splitlines()
    assert f"warning: {runs}/two/run.yaml" in warning
    assert why in warning
    assert f"{runs}: 1 folder in it could not be checked, see the warnings" in error
    listed = {
        run["plan"]: run["changed"] for run in json.loads(Path(words[-1]).read_text())["runs"]
    }
    assert listed.pop("phase-sweep") == []
    assert listed in ({}, {None: None})
    with (runs / "one" / "windows.csv").open("a") as file:
        file.write("0.02,90,9,41000,0,0.18,0.01,0,1,9,1\n")
    assert main(words) == 2
    assert "one: windows.csv changed after the run was closed" in capsys.readouterr().err


def test_what_a_terminal_would_obey_is_not_sent_to_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_run(tmp_path / "run", "\x1b[2J\nphase-sweep", "failed: \x07\u202e" + "x" * 80)
    lines = said_of(capsys, str(tmp_path))
    assert len(lines) == 3
    assert all(line.isprintable() for line in lines)
    assert lines[1].rstrip(" -").endswith("…")


@pytest.mark.parametrize(
    ("words", "message"),
    [(["none"], "none: is no folder"), ([".", "--find", "x"], "KEY=VALUE")],
)
def test_wrong_usage_is_one_line_and_status_2(
    words: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["runs", *words]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert message in said
