"""Runs taken up again: which are, on what bench, and what is said of the others."""

from pathlib import Path

import pytest
import yaml

from tests.usmbench.cli.swept_bench import Opened
from usmbench.cli.main import main
from usmbench.runs.writer import RunWriter


def test_ctrl_c_closes_the_run_and_resume_ends_it(
    opened: Opened, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "out"
    opened.interrupt_at_block = 40
    motor = ["--seed", "7", "--defect", "command_queue=4"]
    arguments = ["--bench", "simulated", *motor, "--out", str(folder)]
    assert main(["sweep", str(plan), *arguments]) == 130
    assert capsys.readouterr().out == f"{folder}\n"
    assert yaml.safe_load((folder / "run.yaml").read_text())["exit"] == "interrupted"
    assert len((folder / "pairs.csv").read_text().splitlines()) == 2
    opened.interrupt_at_block = 0
    plan.unlink()
    assert main(["sweep", "--resume", str(folder)]) == 0
    # The same motor with other noise.
    assert opened.arguments[1][1] == ["--seed", "8", *motor[2:]]
    assert len((folder / "pairs.csv").read_text().splitlines()) == 4
    capsys.readouterr()
    assert main(["sweep", "--resume", str(folder)]) == 2
    assert "nothing to resume" in capsys.readouterr().err


def test_a_run_without_its_plan_cannot_be_taken_up(
    opened: Opened, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "run.yaml").write_text("format: usmbench-run/1\n")
    assert main(["sweep", "--resume", str(tmp_path)]) == 2
    assert "has no plan" in capsys.readouterr().err


def interrupted_run(opened: Opened, plan: Path, folder: Path) -> dict[str, bytes]:
    """Leave a run of the simulated bench as Ctrl-C does, and return its files."""
    opened.interrupt_at_block = 40
    assert main(["sweep", str(plan), "--bench", "simulated", "--out", str(folder)]) == 130
    opened.interrupt_at_block = 0
    opened.generators.clear()
    return {file.name: file.read_bytes() for file in folder.iterdir()}


@pytest.mark.parametrize(
    ("other", "words"),
    [
        ({"encoder": {"lines": 1000}}, "2000 counts per revolution, other.yaml has 4000"),
        ({"daq": {"family": "e_series"}}, "2000 counts per revolution, other.yaml has 500"),
        ({"daq": {"sample_rate_hz": 50000}}, "100000 samples per second, other.yaml has 50000"),
        ({"daq": {"samples_per_average": 500}}, "1000 samples per window, other.yaml has 500"),
        ({"name": "lab"}, "the bench simulated, on other.yaml is another motor"),
    ],
)
def test_a_run_is_not_taken_up_on_a_bench_whose_rows_are_others(
    opened: Opened,
    plan: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    other: dict[str, object],
    words: str,
) -> None:
    before = interrupted_run(opened, plan, tmp_path / "out")
    bench = {"format": "usmbench-bench/1", "name": "simulated"}
    Path("other.yaml").write_text(yaml.safe_dump(bench | other))
    capsys.readouterr()
    assert main(["sweep", "--resume", "out", "--bench", "other.yaml"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert said.err.startswith("usmbench: out/run.yaml: was measured ")
    assert words in said.err
    assert opened.generators == []
    assert {file.name: file.read_bytes() for file in (tmp_path / "out").iterdir()} == before


def test_a_run_is_not_taken_up_on_another_motor(
    opened: Opened, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    interrupted_run(opened, plan, tmp_path / "out")
    file = tmp_path / "out" / "run.yaml"
    meta = yaml.safe_load(file.read_text())
    meta["bench"]["name"], meta["motor"] = "lab", "first"
    file.write_text(yaml.safe_dump(meta))
    Path("other.yaml").write_text("format: usmbench-bench/1\nname: lab\nmotor: second\n")
    assert main(["sweep", "--resume", "out", "--bench", "other.yaml"]) == 2
    assert "on the motor first, other.yaml has second" in capsys.readouterr().err
    assert opened.generators == []


def test_a_run_is_taken_up_at_another_port_and_other_limits(
    opened: Opened, plan: Path, tmp_path: Path
) -> None:
    interrupted_run(opened, plan, tmp_path / "out")
    other = {
        "format": "usmbench-bench/1",
        "name": "simulated",
        "generator": {"port": "/dev/ttyUSB7"},
        "daq": {"address": "somewhere:31763"},
        "interlocks": {"overspeed_rad_s": 15.0},
    }
    Path("other.yaml").write_text(yaml.safe_dump(other))
    assert main(["sweep", "--resume", "out", "--bench", "other.yaml"]) == 0
    assert yaml.safe_load((tmp_path / "out" / "run.yaml").read_text())["exit"] == "completed"


def test_a_run_that_another_program_writes_is_refused_before_the_bench_is_opened(
    opened: Opened, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("fcntl")
    folder = tmp_path / "out"
    interrupted_run(opened, plan, folder)
    capsys.readouterr()
    writer = RunWriter.resume(folder)
    assert main(["sweep", "--resume", str(folder)]) == 2
    output = capsys.readouterr()
    assert (output.out, output.err.count("\n")) == ("", 1)
    assert f"{folder}: another program writes this run" in output.err
    assert opened.generators == []
    writer.close("interrupted")
    assert main(["sweep", "--resume", str(folder)]) == 0


@pytest.mark.parametrize("damage", ["nan", "lost"])
def test_a_damaged_run_is_refused_before_the_bench_is_opened(
    opened: Opened, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], damage: str
) -> None:
    folder = tmp_path / "out"
    interrupted_run(opened, plan, folder)
    capsys.readouterr()
    windows = folder / "windows.csv"
    if damage == "nan":
        windows.write_text(windows.read_text() + ",".join(["nan"] * 11) + "\n")
    else:
        windows.unlink()
    assert main(["sweep", "--resume", str(folder)]) == 2
    output = capsys.readouterr()
    assert (output.out, output.err.count("\n")) == ("", 1)
    assert f"usmbench: {windows}" in output.err
    assert opened.generators == []
