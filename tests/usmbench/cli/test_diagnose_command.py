"""What a user meets: files, exit statuses, and experiments run until one cause is left."""

import json
import subprocess
import sys
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml

from usmbench.cli import deciding_runs, diagnose_command
from usmbench.cli.deciding_runs import Judged
from usmbench.cli.main import main
from usmbench.cli.simulated_motor import SimulatedMotor
from usmbench.diagnose.experiment.proposal import planned_record
from usmbench.errors import BenchError, InputError
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.model_file import write_model
from usmbench.model.simulate import simulate
from usmbench.runs.reader import read_run
from usmbench.runs.record import Record
from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan import Plan

CHECKER = Path(__file__).parents[4] / "shared" / "tools" / "check-contract"
NOISE_RAD_S = 0.03
LATE = {"name": "transport_delay", "form": "", "parameters": {"delay_s": 0.04}}


def motor() -> HammersteinModel:
    knots_deg = np.array([-90.0, -45.0, 0.0, 45.0, 90.0])
    curve = StaticCurve(knots_deg, np.array([-10.0, -8.0, 0.0, 8.0, 10.0]))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (-4.0, 4.0), NOISE_RAD_S)
    return HammersteinModel(LinearPart(np.array([-0.04]), np.array([0.96]), 0, 0.01), (point,), "x")


def measured(record: Record, file: Path, seed: int, *effects: dict[str, Any]) -> Path:
    """Write what a motor with some effects shows as a bare CSV."""
    run = simulate(replace(motor(), effects=effects), record.phase_deg)
    noise = NOISE_RAD_S * np.random.default_rng(seed).standard_normal(record.t_s.size)
    columns = np.column_stack(
        [record.t_s, record.phase_deg, run.speed_rad_s + noise, np.full(record.t_s.size, 41_000.0)]
    )
    header = "t_s,phase_deg,speed_rad_s,frequency_hz"
    np.savetxt(file, columns, fmt="%.6f", delimiter=",", header=header, comments="")
    return file


@pytest.fixture
def model_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_model(tmp_path / "model.yaml", motor())
    return tmp_path / "model.yaml"


@pytest.fixture(scope="module")
def triangle() -> Record:
    there = np.r_[np.arange(0, 90, 0.5), np.arange(90, -90, -0.5), np.arange(-90, 0, 0.5)]
    phase_deg = np.repeat(there, 4)
    window_s = np.full(phase_deg.size, 0.01)
    return Record("triangle", np.cumsum(window_s), phase_deg, 0.0 * phase_deg, window_s)


@pytest.fixture(scope="module")
def late(triangle: Record, tmp_path_factory: pytest.TempPathFactory) -> Judged:
    """What is said of the triangle on a motor that acts late."""
    run = measured(triangle, tmp_path_factory.mktemp("late") / "run.csv", 5, LATE)
    return deciding_runs.judge([read_run(run)], motor())


class Bench:
    """Stands for the bench: writes what the late motor would show under a plan."""

    def __init__(self) -> None:
        self.plans: list[Plan] = []
        self.motors: list[SimulatedMotor] = []

    def measure(self, plan: Plan, bench: str, motor_: SimulatedMotor, folder: Path) -> None:
        self.plans.append(plan)
        self.motors.append(motor_)
        folder.parent.mkdir(exist_ok=True)
        measured(planned_record(plan, motor(), 0.01), folder, 10 + len(self.plans), LATE)


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    bench = Bench()
    monkeypatch.setattr(deciding_runs, "_measure", bench.measure)
    return bench


def test_all_files_are_written_and_sweep_takes_the_plan(
    model_file: Path,
    late: Judged,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(diagnose_command, "judge", lambda records, model: late)
    run = late.records[0].name
    outputs = ["--out", "extended.yaml", "--json", "found.json", "--report", "report.html"]
    words = [str(run), "--model", str(model_file), *outputs, "--next", "next.yaml"]
    assert main(["diagnose", *words]) == 0
    found = json.loads(Path("found.json").read_text())
    said = capsys.readouterr().out
    assert said.startswith("verdict    explained")
    causes = {found["causes"][0]["name"], *found["causes"][0]["alternatives"]}
    assert {"transport_delay", "dead_zone_hysteresis"} <= causes
    for parameter in found["causes"][0]["parameters"]:
        assert f"\n           {parameter}: " in said
    proposal = found["next_experiment"]
    assert f"next       {proposal['says']}" in said
    assert yaml.safe_load(Path("next.yaml").read_text()) == proposal["plan"]
    assert main(["sweep", "next.yaml", "--dry-run"]) == 0
    assert "duration" in capsys.readouterr().out
    page = Path("report.html").read_text("utf-8")
    assert "The next experiment" in page
    assert "next-experiment" in page
    assert main(["replay", str(run), "--model", "extended.yaml", "--json", "replay.json"]) == 0
    assert json.loads(Path("replay.json").read_text())["rmse_rad_s"] < 2.0 * NOISE_RAD_S
    if CHECKER.exists():
        words = [sys.executable, str(CHECKER), "diagnose", "found.json"]
        checked = subprocess.run(words, capture_output=True, text=True, check=False)
        assert checked.returncode == 0, checked.stdout


def test_with_a_bench_it_goes_on_until_one_cause_is_left(
    model_file: Path,
    triangle: Record,
    tmp_path: Path,
    bench: Bench,
    capsys: pytest.CaptureFixture[str],
) -> None:
    run = measured(triangle, tmp_path / "run.csv", 5, LATE)
    words = [str(run), "--model", str(model_file), "--bench", "simulated", "--json", "found.json"]
    words += ["--report", "found.html"]
    assert main(["diagnose", *words, "--runs-folder", str(tmp_path / "more")]) == 0
    found = json.loads(Path("found.json").read_text())
    assert found["causes"][0]["name"] == "transport_delay"
    assert found["causes"][0]["alternatives"] == []
    assert found["next_experiment"] is None
    assert 1 <= len(bench.plans) <= 3
    assert bench.motors[0].seed == 1
    said = capsys.readouterr().out
    assert said.count("driven     ") == len(bench.plans)
    folders = list((tmp_path / "more").iterdir())
    assert len(folders) == len(bench.plans)
    page = Path("found.html").read_text("utf-8").split("Experiments that were driven")[1]
    assert all(folder.name in page for folder in folders)


def test_the_budget_ends_it(
    late: Judged, tmp_path: Path, bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bench on which every experiment leaves the question open."""
    monkeypatch.setattr(
        deciding_runs, "judge", lambda records, model: replace(late, records=tuple(records))
    )
    judged = list(deciding_runs.decide(late, motor(), "bench.yaml", 2, tmp_path / "runs"))
    assert [len(each.records) for each in judged] == [2, 3]
    assert late.diagnosis.next_experiment is not None
    assert [why for _, why in judged[-1].driven] == [late.diagnosis.next_experiment["says"]] * 2
    assert len(bench.plans) == 2


def test_an_experiment_has_the_noise_of_no_run_in_hand(
    late: Judged, tmp_path: Path, bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same noise twice would look like a cause; a run taken up again has had a further one."""
    runs = tuple(
        replace(late.records[0], meta=meta) for meta in ({"seed": 1}, {"seed": 2, "resumed": ["t"]})
    )
    first = replace(late, records=runs)
    monkeypatch.setattr(
        deciding_runs, "judge", lambda records, model: replace(first, records=tuple(records))
    )
    assert len(list(deciding_runs.decide(first, motor(), "simulated", 2, tmp_path / "runs"))) == 2
    assert [motor.seed for motor in bench.motors] == [4, 5]


@pytest.mark.parametrize(
    ("error", "status"), [(KeyboardInterrupt(), 130), (BenchError("the port is gone"), 3)]
)
def test_what_was_found_before_the_bench_failed_is_said_and_written(
    model_file: Path,
    late: Judged,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    error: BaseException,
    status: int,
) -> None:
    said: list[str] = []

    def failing(*_: object) -> None:
        said.append(capsys.readouterr().out)
        raise error

    monkeypatch.setattr(diagnose_command, "judge", lambda records, model: late)
    monkeypatch.setattr(deciding_runs, "_measure", failing)
    outputs = ["--json", "found.json", "--report", "report.html", "--next", "next.yaml"]
    words = [str(late.records[0].name), "--model", str(model_file), "--bench", "simulated"]
    assert main(["diagnose", *words, *outputs]) == status
    assert said[0].startswith("verdict    explained")
    assert json.loads(Path("found.json").read_text())["verdict"] == "explained"
    assert Path("next.yaml").exists()
    assert Path("report.html").exists()


def test_the_folder_of_an_experiment_that_was_stopped_is_named_beside_the_json(
    late: Judged,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def stopped(bench: object, plan: object, folder: Path, **_: object) -> None:
        folder.mkdir(parents=True)
        (folder / "run.yaml").write_text("format: usmbench-run/1\n")
        raise KeyboardInterrupt

    opened = SimpleNamespace(settings=BenchSettings())
    monkeypatch.setattr(deciding_runs, "open_bench", lambda *_, **__: nullcontext(opened))
    monkeypatch.setattr(deciding_runs, "sweep_new", stopped)
    with pytest.raises(KeyboardInterrupt):
        next(deciding_runs.decide(late, motor(), "simulated", 1, tmp_path / "runs"))
    (folder,) = (tmp_path / "runs").iterdir()
    output = capsys.readouterr()
    assert output.err == f"{folder}\n"
    assert output.out == ""


def test_json_alone_goes_to_standard_output_though_the_bench_failed(
    model_file: Path,
    late: Judged,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def failing(*_: object) -> None:
        raise BenchError("the port is gone")

    monkeypatch.setattr(diagnose_command, "judge", lambda records, model: late)
    monkeypatch.setattr(deciding_runs, "_measure", failing)
    words = [str(late.records[0].name), "--model", str(model_file), "--bench", "simulated"]
    assert main(["diagnose", *words, "--json", "-"]) == 3
    assert json.loads(capsys.readouterr().out)["verdict"] == "explained"


@pytest.mark.parametrize(
    ("meta", "window_s", "says"),
    [
        ({"bench": {"name": "bench-b"}}, 0.01, "was measured on the bench bench-b"),
        ({}, 0.02, "windows are 20 ms long, those of simulated 10 ms"),
    ],
)
def test_a_bench_that_did_not_measure_the_runs_is_refused_before_anything_moves(
    triangle: Record, tmp_path: Path, meta: dict[str, object], window_s: float, says: str
) -> None:
    record = replace(triangle, meta=meta, window_s=np.full(triangle.t_s.size, window_s))
    with pytest.raises(InputError, match=says):
        deciding_runs.check_bench([record], "simulated", tmp_path)


def test_a_clock_that_jitters_is_no_other_bench(triangle: Record, tmp_path: Path) -> None:
    window_s = np.full(triangle.t_s.size, 0.01003)
    record = replace(triangle, meta={"bench": {"name": "simulated"}}, window_s=window_s)
    assert deciding_runs.check_bench([record], "simulated", tmp_path) == []


def test_a_run_of_another_motor_than_the_benchs_is_refused(
    triangle: Record, tmp_path: Path
) -> None:
    bench = tmp_path / "bench.yaml"
    bench.write_text("format: usmbench-bench/1\nname: lab\nmotor: second\n")
    record = replace(triangle, meta={"bench": {"name": "lab"}, "motor": "first"})
    with pytest.raises(InputError, match="measured on the motor first"):
        deciding_runs.check_bench([record], str(bench), tmp_path)
    alike = replace(record, meta={"bench": {"name": "lab"}, "motor": "second"})
    assert deciding_runs.check_bench([alike], str(bench), tmp_path) == []


def test_runs_of_two_simulated_motors_are_refused_and_a_run_of_no_known_bench_is_told(
    triangle: Record, tmp_path: Path
) -> None:
    meta = {"bench": {"name": "simulated"}}
    two = [replace(triangle, meta={**meta, "defects": [d]}) for d in ("a=1", "b=1")]
    with pytest.raises(InputError, match="different simulated motors"):
        deciding_runs.check_bench(two, "simulated", tmp_path)
    followed = replace(triangle, meta={**meta, "model_file": "m.yaml"})
    with pytest.raises(InputError, match="followed a model file; drive the proposed plan"):
        deciding_runs.check_bench([followed], "simulated", tmp_path)
    assert len(deciding_runs.check_bench([triangle], "simulated", tmp_path)) == 1


def test_a_file_for_a_folder_of_runs_is_refused(triangle: Record, tmp_path: Path) -> None:
    (tmp_path / "runs").touch()
    with pytest.raises(InputError, match="is no folder"):
        deciding_runs.check_bench([triangle], "simulated", tmp_path / "runs")


def test_a_run_as_simulated_proposes_nothing_and_writes_no_plan(
    model_file: Path, triangle: Record, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = measured(triangle, tmp_path / "run.csv", 8)
    words = [str(run), "--model", str(model_file), "--next", "next.yaml", "--json", "-"]
    assert main(["diagnose", *words]) == 0
    output = capsys.readouterr()
    found = json.loads(output.out)
    assert found["verdict"] == "no_discrepancy"
    assert found["causes"] == []
    if found["next_experiment"] is None:
        assert "next.yaml is not written" in output.err
    assert Path("next.yaml").exists() == (found["next_experiment"] is not None)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--budget", "2"], "--bench"),
        (["--runs-folder", "x"], "--bench"),
        (["--bench", "simulated", "--budget", "0"], "at least 1"),
        (["--next", "absent/next.yaml"], "absent/next.yaml: cannot be written"),
        (["--report", "absent/report.html"], "absent/report.html: cannot be written"),
        (["--json", "absent/found.json"], "absent/found.json: cannot be written"),
    ],
)
def test_bad_input_is_one_line_and_status_2(
    model_file: Path,
    late: Judged,
    words: list[str],
    says: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(diagnose_command, "judge", lambda records, model: late)
    run = late.records[0].name
    assert main(["diagnose", run, "--model", str(model_file), *words]) == 2
    said = capsys.readouterr().err
    assert says in said
    assert said.strip().count("\n") == 0
