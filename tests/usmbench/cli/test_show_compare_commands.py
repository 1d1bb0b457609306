"""usmbench show and usmbench compare: what they say, and that they draw."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from usmbench.cli.main import main
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.model_file import write_model
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import PairRow, WindowRow

PHASES = (-60.0, -30.0, 0.0, 30.0, 60.0)


def make_run(
    folder: Path, *, offset_rad_s: float = 0.0, points: int = 1, settled: bool = True
) -> Path:
    """Make a run over some phases, up and down, at so many frequencies."""
    meta = {"motor": "Shinsei USR60", "plan": {"name": "short"}, "seed": offset_rad_s}
    writer = RunWriter.create(folder, meta, temperature=True, raw=False)
    t_s, dwell = 0.0, 0
    for point in range(points):
        frequency_hz = 41_000.0 + 100.0 * point
        for direction in (1, -1):
            for phase_deg in PHASES[::direction]:
                speed_rad_s = 0.1 * phase_deg + offset_rad_s
                for _ in range(6):
                    t_s += 0.01
                    writer.window(
                        WindowRow(
                            *(t_s, phase_deg, speed_rad_s, frequency_hz, 0.0, 0.0, 0.01),
                            *(0, int(settled), speed_rad_s, 1, 25.0),
                        )
                    )
                if settled:
                    row = (phase_deg, frequency_hz, 0.0, speed_rad_s, 0.01, 6)
                    writer.pair(PairRow(*row, direction, t_s, dwell, 1))
                dwell += 1
    writer.close("completed")
    return folder


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def is_png(file: Path) -> bool:
    return file.read_bytes().startswith(b"\x89PNG")


def test_show_says_what_the_run_is_and_draws_it(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_run(here / "run")
    assert main(["show", "run"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "plan        short" in lines
    assert "windows     60 of 10 ms, 0.60 s in all" in lines
    assert "speed       -6 to 6 rad/s" in lines
    assert "temperature 25.0 to 25.0 °C" in lines
    assert lines[-1] == "plot        show.png"
    assert is_png(here / "show.png")


@pytest.mark.parametrize("points", [2, 10])
def test_every_operating_point_has_its_panel(here: Path, points: int) -> None:
    make_run(here / "one", points=points)
    make_run(here / "other", points=points, offset_rad_s=0.1)
    curve = StaticCurve(np.array([-60.0, 60.0]), np.array([-6.0, 6.0]))
    fitted = OperatingPoint(41e3, None, curve, (-60.0, 60.0), (None, None), 0.0)
    linear = LinearPart(np.array([-0.5]), np.array([0.5]), 0, 0.01)
    write_model(here / "model.yaml", HammersteinModel(linear, (fitted,), "fast"))
    words = ["show", "one", "--model", "model.yaml", "--plot", "one.svg"]
    assert main(words) == 0
    svg = (here / "one.svg").read_text(encoding="utf-8")
    assert svg.count("<!-- rising φ -->") == min(points, 9)
    assert ("9 of 10 operating points are drawn" in svg) == (points == 10)
    assert svg.count("<!-- model -->") == 1
    assert main(["compare", "one", "other", "--plot", "both.svg"]) == 0
    svg = (here / "both.svg").read_text(encoding="utf-8")
    assert svg.count("<!-- B − A (rad/s) -->") == min(points, 9)


def test_compare_says_how_far_two_runs_are_apart(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_run(here / "one")
    make_run(here / "other", offset_rad_s=0.25)
    assert main(["compare", "one", "other"]) == 0
    said = capsys.readouterr().out
    assert "settings in both           10\n" in said
    assert "second less first, mean    +0.25 rad/s" in said
    assert "they differ in             seed: 0.0 | 0.25\n" in said
    assert is_png(here / "compare.png")
    assert main(["compare", "one", "other", "--json", "-"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["n"] == 10
    assert found["rms_difference_rad_s"] == pytest.approx(0.25)
    assert found["differing_keys"] == ["seed"]


def test_a_plan_that_only_one_run_has_is_told_by_its_name(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_run(here / "one")
    other = make_run(here / "other") / "run.yaml"
    head = other.read_text("utf-8")
    other.write_text(head.replace("plan:", "former_plan:"), "utf-8")
    assert main(["compare", "one", "other"]) == 0
    said = capsys.readouterr().out
    assert "they differ in             plan: short | None\n" in said


def test_a_bare_csv_and_a_run_without_pairs_are_shown(here: Path) -> None:
    (here / "bare.csv").write_text("phase_deg,speed_rad_s\n" + "0,0\n" * 6 + "9,1\n" * 6)
    assert main(["show", "bare.csv", "--plot", "bare.pdf"]) == 0
    assert main(["show", "bare.csv", "--plot", "bare.svg"]) == 0
    assert (here / "bare.svg").read_text(encoding="utf-8").count("<!-- rising φ -->") == 1
    assert main(["compare", "bare.csv", "bare.csv", "--plot", "both.svg"]) == 0
    assert (here / "both.svg").read_text(encoding="utf-8").count("<!-- B − A (rad/s) -->") == 1
    make_run(here / "unsettled", settled=False)
    assert main(["show", "unsettled", "--plot", "unsettled.png"]) == 0
    assert is_png(here / "unsettled.png")


def test_a_hostile_name_is_only_a_name(here: Path) -> None:
    name = "$\\frac{1}$\x1b[2J 運転 " + "x" * 80
    make_run(here / name)
    for words in (["show", name], ["compare", name, name]):
        command = [sys.executable, "-m", "usmbench", *words]
        done = subprocess.run(command, capture_output=True, text=True, cwd=here)
        assert (done.returncode, done.stderr) == (0, "")
        assert all(line.isprintable() for line in done.stdout.splitlines())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["show", "none"], "none: cannot be read"),
        (["show", "run", "--plot", "run.xyz"], "run.xyz: its ending names no format"),
        (["show", "run", "--plot", "run"], "run: is what this command reads"),
        (["show", "run", "--plot", "none/run.png"], "none/run.png: cannot be written"),
        (["show", "run", "--model", "none.yaml"], "none.yaml: cannot be read"),
        (["compare", "run", "none"], "none: cannot be read"),
        (["compare", "run", "unsettled"], "unsettled: no dwell of this run settled"),
        (["compare", "run", "high"], "no phase, frequency, torque and direction"),
        (["show", "wild.csv"], "wild.csv:4: speed_rad_s is 1e+200"),
        (["compare", "run", "wild.csv", "--json", "-"], "wild.csv:4: speed_rad_s is 1e+200"),
        (["export", "wild.csv", "wild.mat"], "wild.csv:4: speed_rad_s is 1e+200"),
        (["compare", "run"], "the following arguments are required: RUN"),
    ],
)
def test_wrong_usage_is_one_line_and_status_2(
    here: Path, words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    make_run(here / "run")
    make_run(here / "unsettled", settled=False)
    (here / "wild.csv").write_text("phase_deg,speed_rad_s\n-30,-3\n0,0\n30,1e200\n60,6\n")
    (here / "high").mkdir()
    for name in ("run.yaml", "windows.csv"):
        text = (here / "run" / name).read_text()
        (here / "high" / name).write_text(text.replace(",41000,", ",42000,"))
    assert main(words) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert message in said
