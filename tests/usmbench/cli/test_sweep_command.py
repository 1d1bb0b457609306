"""What a user meets: arguments, messages, exit statuses, paths."""

from pathlib import Path

import pytest
import yaml

from tests.usmbench.cli.swept_bench import PLAN, Opened
from usmbench.cli.main import main


def test_the_path_of_the_run_is_all_that_standard_output_gets(
    opened: Opened, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, log = tmp_path / "out", tmp_path / "frames.log"
    arguments = ["--bench", "simulated", "--seed", "7", "--out", str(folder)]
    assert main(["sweep", str(plan), *arguments, "--frame-log", str(log)]) == 0
    output = capsys.readouterr()
    assert (output.out, output.err) == (f"{folder}\n", "")
    assert opened.arguments == [("simulated", ["--seed", "7"])]
    assert yaml.safe_load((folder / "run.yaml").read_text())["seed"] == 7
    assert log.stat().st_size > 0


def test_the_default_folder_is_one_of_runs(
    opened: Opened, plan: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", str(plan), "--bench", "simulated"]) == 0
    folder = Path(capsys.readouterr().out.strip())
    assert folder.parent == Path("runs")
    assert folder.name.endswith("-short")
    assert (folder / "pairs.csv").exists()


def test_the_simulated_motor_may_be_a_model_file(
    opened: Opened, plan: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "out"
    words = ["--bench", "simulated", "--model", "extended.yaml", "--out", str(folder)]
    assert main(["sweep", str(plan), *words]) == 0
    assert opened.arguments[0][1] == ["--model", "extended.yaml"]
    assert yaml.safe_load((folder / "run.yaml").read_text())["model_file"] == "extended.yaml"


def test_a_dry_run_opens_nothing(
    opened: Opened, plan: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", str(plan), "--dry-run"]) == 0
    assert "duration   1.0 s" in capsys.readouterr().out
    assert opened.arguments == []
    assert not Path("runs").exists()


def test_a_plan_cannot_speak_to_the_terminal(
    opened: Opened, plan: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", str(wrong(plan, name="a\x1b[2Jb")), "--dry-run"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "plan       a�[2Jb"
    assert all(line.isprintable() for line in lines)


@pytest.mark.parametrize(("windows", "outcome"), [(20, "completed"), (2000, "failed: /dev/full")])
def test_a_frame_log_without_room_is_named(
    opened: Opened,
    plan: Path,
    capsys: pytest.CaptureFixture[str],
    windows: int,
    outcome: str,
) -> None:
    wrong(plan, dwell=PLAN["dwell"] | {"windows": windows})
    words = ["--bench", "simulated", "--out", "out", "--frame-log", "/dev/full"]
    assert main(["sweep", str(plan), *words]) == 3
    output = capsys.readouterr()
    assert output.out == "out\n"
    assert output.err == (
        "usmbench: /dev/full: the frame log cannot be written (No space left on device); "
        "free some space, or leave the log out\n"
    )
    assert yaml.safe_load(Path("out/run.yaml").read_text())["exit"].startswith(outcome)


def wrong(plan: Path, **keys: object) -> Path:
    plan.write_text(yaml.safe_dump(PLAN | keys))
    return plan


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["absent.yaml", "--bench", "simulated"], "no plan file absent.yaml"),
        (["plan.yaml"], "--bench simulated"),
        (["--bench", "simulated"], "no plan was named"),
        (["plan.yaml", "--bench", "absent.yaml"], "absent.yaml: cannot be read"),
        (["plan.yaml", "--bench", "plan.yaml"], "write usmbench-bench/1"),
        (["plan.yaml", "--bench", "bench.yaml", "--seed", "3"], "leave it out"),
        (["plan.yaml", "--bench", "bench.yaml", "--defect", "spikes"], "leave it out"),
        (["plan.yaml", "--bench", "bench.yaml", "--model", "m.yaml"], "leave it out"),
        (["plan.yaml", "--bench", "simulated", "--out", "."], "exists already"),
        (["plan.yaml", "--resume", "out"], "leave PLAN.yaml out"),
        (["--resume", "out", "--dry-run"], "leave --dry-run out"),
        (["--resume", "out", "--seed", "0"], "leave --seed out"),
        (["--resume", "out", "--defect", "worn_contact"], "leave --defect out"),
        (["--resume", "nowhere"], "run.yaml"),
        (["plan.yaml", "--bench", "simulated", "--frame-log", "a/b"], "a folder that exists"),
        (["plan.yaml", "--bench", "simulated", "--seed", "x"], "--seed"),
    ],
)
def test_bad_input_is_one_line_and_moves_nothing(
    opened: Opened,
    plan: Path,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    words: str,
) -> None:
    assert main(["sweep", *arguments]) == 2
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.count("\n") == 1
    assert words in output.err
    assert opened.generators == []


def test_a_plan_beyond_the_limits_names_its_line_and_opens_nothing(
    opened: Opened, plan: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong(plan, frequency_hz=43000)
    assert main(["sweep", str(plan), "--bench", "simulated"]) == 2
    error = capsys.readouterr().err
    line = next(i for i, text in enumerate(plan.read_text().splitlines(), 1) if "43000" in text)
    assert f"plan.yaml:{line}: frequency_hz: " in error
    assert opened.generators == []
    assert not Path("runs").exists()
