"""What a user meets: arguments, messages, exit statuses, paths."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml

from hil_sim.in_process import InProcessBench
from usmbench.cli import sweep_command
from usmbench.cli.bench_session import Bench
from usmbench.cli.main import main
from usmbench.instruments.generator import SignalGenerator
from usmbench.runs.writer import RunWriter
from usmbench.settings.bench import BenchSettings

PLAN: dict[str, Any] = {
    "format": "usmbench-plan/1",
    "name": "short",
    "frequency_hz": 41000,
    "passes": [{"phase_deg": [-90, 0, 90]}],
    "dwell": {"windows": 20, "settle": {"min_windows": 3, "over_windows": 6}},
}


class SimulatedLoad:
    """The operator of a simulated bench."""

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        """Have no load to set."""

    def load_is_set(self) -> bool:
        return True


class Opened:
    """What was asked of `open_bench`, and what was left behind."""

    def __init__(self) -> None:
        self.arguments: list[tuple[Any, list[str]]] = []
        self.generators: list[SignalGenerator] = []
        self.interrupt_at_block = 0

    @contextmanager
    def open_bench(
        self, bench: Any, *, testbed_arguments: list[str], frame_log: Any
    ) -> Iterator[Bench]:
        self.arguments.append((bench, testbed_arguments))
        settings = replace(BenchSettings(), name="simulated")
        simulated = InProcessBench(3)
        limits = settings.generator
        generator = SignalGenerator(
            simulated.port,
            clock=simulated.clock,
            frequency_limits_hz=limits.frequency_limits_hz,
            phase_limits_deg=limits.phase_limits_deg,
            frame_log=frame_log,
        )
        self.generators.append(generator)
        next_block, blocks = simulated.source.next_block, 0

        def interrupted() -> Any:
            nonlocal blocks
            blocks += 1
            if blocks == self.interrupt_at_block:
                signal.raise_signal(signal.SIGINT)
            return next_block()

        simulated.source.next_block = interrupted  # type: ignore[method-assign]
        yield Bench(settings, generator, simulated.source, SimulatedLoad(), simulated.clock)
        assert not generator.outputs_on


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Opened:
    opened = Opened()
    monkeypatch.setattr(sweep_command, "open_bench", opened.open_bench)
    return opened


@pytest.fixture
def plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "plan.yaml"
    file.write_text(yaml.safe_dump(PLAN))
    return file


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
    opened.interrupt_at_block = 40
    assert main(["sweep", str(plan), "--bench", "simulated", "--out", str(folder)]) == 130
    capsys.readouterr()
    writer = RunWriter.resume(folder)
    assert main(["sweep", "--resume", str(folder)]) == 2
    output = capsys.readouterr()
    assert (output.out, output.err.count("\n")) == ("", 1)
    assert f"{folder}: another program writes this run" in output.err
    assert len(opened.generators) == 1
    writer.close("interrupted")
    opened.interrupt_at_block = 0
    assert main(["sweep", "--resume", str(folder)]) == 0


@pytest.mark.parametrize("damage", ["nan", "lost"])
def test_a_damaged_run_is_refused_before_the_bench_is_opened(
    opened: Opened, plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], damage: str
) -> None:
    folder = tmp_path / "out"
    opened.interrupt_at_block = 40
    assert main(["sweep", str(plan), "--bench", "simulated", "--out", str(folder)]) == 130
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
    assert len(opened.generators) == 1
