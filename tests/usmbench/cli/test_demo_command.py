"""The demo: everything over the wire, on a shorter plan, and what is hidden is found."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from usmbench.cli import demo_command
from usmbench.cli.main import main
from usmbench.errors import InputError
from usmbench.runs.writer import RunWriter
from usmbench.settings.bench import SIMULATED

CHECKER = Path(__file__).parents[4] / "shared" / "tools" / "check-contract"
SHORT = {
    "format": "usmbench-plan/1",
    "name": "short",
    "frequency_hz": 41_000,
    "warm_up": {"phase_deg": 90, "duration_s": 1},
    "passes": [{"phase_deg": {"from": -90, "to": 90, "step": 7.5}, "direction": "both"}],
    "dwell": {"windows": 30},
}


@pytest.fixture
def plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    file = tmp_path / "short.yaml"
    file.write_text(yaml.safe_dump(SHORT))
    monkeypatch.setattr(demo_command, "PLAN", str(file))
    return file


@pytest.mark.usefixtures("plan")
def test_what_is_hidden_is_found_and_all_files_are_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(demo_command, "HIDDEN", {"worn_contact=5": "speed_scale"})
    folder = tmp_path / "demo"
    assert main(["demo", "--out", str(folder)]) == 0
    said = capsys.readouterr().out
    assert re.search(r"Found: speed_scale(,.*)?; knowing it removes ([\d.]+)\s%", said)
    assert {path.name for path in folder.iterdir()} == {
        *demo_command.RUNS,
        *demo_command.WRITTEN,
    }
    effects = yaml.safe_load((folder / "extended.yaml").read_text())["effects"]
    assert effects[0]["name"] == "speed_scale"
    assert effects[0]["parameters"]["scale_error"] == pytest.approx(-0.048, abs=0.015)
    meta = yaml.safe_load((folder / "measured" / "run.yaml").read_text())
    assert (meta["seed"], meta["defects"]) == (3, ["worn_contact=5"])
    if CHECKER.exists():
        checked = subprocess.run(
            [sys.executable, str(CHECKER), "demo", str(folder)],
            capture_output=True,
            text=True,
            check=False,
        )
        assert checked.returncode == 0, checked.stdout


@pytest.mark.parametrize(
    ("causes", "gain", "says"),
    [
        ([{"name": "transport_delay"}], 0.9952, r"transport_delay; knowing it removes 99\.5\s% of"),
        ([], None, "no cause"),
    ],
)
def test_what_is_left_is_not_rounded_away(
    causes: list[dict[str, str]], gain: float | None, says: str
) -> None:
    hidden = next(iter(demo_command.HIDDEN))
    said = demo_command._comparison(hidden, {"causes": causes, "gain": gain})
    assert re.search(rf"{hidden}.*\nFound: {says}", said)


@pytest.mark.parametrize("name", ["holiday.jpg", "model.yml"])
def test_a_folder_with_something_else_in_it_is_left_alone(
    tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / name).write_text("dear to somebody")
    assert main(["demo", "--out", str(tmp_path)]) == 2
    assert f"holds {name}" in capsys.readouterr().err
    assert (tmp_path / name).read_text() == "dear to somebody"


def test_a_folder_named_like_a_run_that_is_none_is_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "measured").mkdir()
    (tmp_path / "measured" / "thesis.tex").write_text("three years")
    assert main(["demo", "--out", str(tmp_path)]) == 2
    assert "run.yaml" in capsys.readouterr().err
    assert (tmp_path / "measured" / "thesis.tex").exists()


def _old_run(folder: Path, bench: str = SIMULATED, name: str = "short") -> Path:
    meta = {"bench": {"name": bench}, "plan": SHORT | {"name": name}}
    RunWriter.create(folder, meta, temperature=False, raw=False).close("completed")
    return folder


@pytest.mark.usefixtures("plan")
def test_the_runs_of_an_earlier_demo_are_replaced(tmp_path: Path) -> None:
    old = [_old_run(tmp_path / "demo" / name) for name in demo_command.RUNS]
    demo_command._make_room(tmp_path / "demo")
    assert not any(run.exists() for run in old)


@pytest.mark.usefixtures("plan")
@pytest.mark.parametrize(("bench", "name"), [("lab", "short"), (SIMULATED, "mine")])
def test_a_run_that_no_demo_drove_is_left_alone(
    tmp_path: Path, bench: str, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "lab"
    ours, theirs = _old_run(folder / "reference"), _old_run(folder / "measured", bench, name)
    assert main(["demo", "--out", str(folder)]) == 2
    assert capsys.readouterr().err == (
        f"usmbench: {theirs}: is a run that no demo drove; name another with --out\n"
    )
    assert (ours / "windows.csv").exists()
    assert (theirs / "windows.csv").exists()


@pytest.mark.usefixtures("plan")
def test_a_link_to_a_run_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "demo").mkdir()
    _old_run(tmp_path / "demo" / "reference")
    (tmp_path / "demo" / "measured").symlink_to(_old_run(tmp_path / "elsewhere"))
    with pytest.raises(InputError, match="measured: is a run that no demo drove"):
        demo_command._make_room(tmp_path / "demo")
    assert (tmp_path / "demo" / "reference").exists()


def test_a_seed_below_zero_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["demo", "--out", str(tmp_path / "demo"), "--seed", "-1"]) == 2
    assert "0 or more" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["file", "file/demo", "loop", "loop/demo"])
def test_a_folder_that_cannot_be_made_is_one_line(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "loop").symlink_to("loop")
    assert main(["demo", "--out", str(tmp_path / name)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"usmbench: {tmp_path / name}: cannot be made: ")
    assert err.count("\n") == 1


def test_the_status_is_that_of_the_step_that_ended_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(demo_command, "PLAN", "no-such-plan")
    assert main(["demo", "--out", str(tmp_path / "demo")]) == 2
    assert "the demo ends here: `usmbench sweep` returned 2" in capsys.readouterr().err
