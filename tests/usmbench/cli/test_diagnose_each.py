"""Many runs at once: over all cores and over a Dask cluster, as one by one."""

import json
import sys
import time
from concurrent.futures import Executor, Future
from dataclasses import replace
from multiprocessing import active_children
from pathlib import Path
from socket import create_server
from typing import Any

import numpy as np
import pytest
from distributed import LocalCluster

from stuck_worker import stuck
from usmbench.cli import each_run, executors
from usmbench.cli.main import main
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.model_file import write_model
from usmbench.model.simulate import simulate

NOISE_RAD_S = 0.03
EFFECTS = {
    "as-simulated": (),
    "shifted": ({"name": "phase_offset", "form": "", "parameters": {"offset_deg": 3.0}},),
    "shifted-back": ({"name": "phase_offset", "form": "", "parameters": {"offset_deg": -3.0}},),
}


def motor() -> HammersteinModel:
    knots_deg = np.array([-90.0, -45.0, 0.0, 45.0, 90.0])
    curve = StaticCurve(knots_deg, np.array([-10.0, -8.0, 0.0, 8.0, 10.0]))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (-4.0, 4.0), NOISE_RAD_S)
    return HammersteinModel(LinearPart(np.array([-0.04]), np.array([0.96]), 0, 0.01), (point,), "x")


def write_run(file: Path, effects: tuple[dict[str, Any], ...], seed: int) -> None:
    """Write what the motor shows in a triangle, as a bare CSV."""
    there = np.r_[np.arange(0, 90, 2.0), np.arange(90, -90, -2.0), np.arange(-90, 0, 2.0)]
    phase_deg = np.repeat(there, 4)
    speed_rad_s = simulate(replace(motor(), effects=effects), phase_deg).speed_rad_s
    speed_rad_s += NOISE_RAD_S * np.random.default_rng(seed).standard_normal(phase_deg.size)
    columns = np.column_stack([phase_deg, speed_rad_s])
    header = "phase_deg,speed_rad_s"
    np.savetxt(file, columns, fmt="%.6f", delimiter=",", header=header, comments="")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model, three runs, and a file that is none."""
    folder = tmp_path_factory.mktemp("each")
    write_model(folder / "model.yaml", motor())
    for seed, (name, effects) in enumerate(EFFECTS.items()):
        write_run(folder / f"{name}.csv", effects, seed)
    (folder / "broken.csv").write_text("phase_deg,speed_rad_s\n10,1.0\n20,fast\n")
    return folder


@pytest.fixture(scope="module")
def one_by_one(folder: Path) -> list[dict[str, Any]]:
    found = []
    for name in EFFECTS:
        words = [str(folder / f"{name}.csv"), "--model", str(folder / "model.yaml")]
        assert main(["diagnose", *words, "--json", str(folder / "one.json")]) == 0
        found.append(json.loads((folder / "one.json").read_text()))
    return found


def assert_as_one_by_one(words: list[str], expected: list[dict[str, Any]]) -> None:
    """Diagnose all of a folder at once, the broken file second."""
    runs = ["as-simulated.csv", "broken.csv", "shifted.csv", "shifted-back.csv"]
    assert main(["diagnose", *runs, "--model", "model.yaml", "--json", "each.json", *words]) == 2
    entries = json.loads(Path("each.json").read_text())["runs"]
    assert [entry.pop("run") for entry in entries] == runs
    broken = entries.pop(1)
    assert list(broken) == ["error"]
    assert broken["error"].startswith("broken.csv:3: ")  # as it was given
    assert entries == expected


def test_all_cores_find_what_one_by_one_is_found(
    folder: Path,
    one_by_one: list[dict[str, Any]],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(folder)
    assert_as_one_by_one(["--each"], one_by_one)
    said = capsys.readouterr()
    head, *lines = said.out.splitlines()
    assert head.split() == ["run", "verdict", "gain", "cause"]
    assert lines[0].split() == ["as-simulated.csv", "no_discrepancy"]
    assert lines[1].startswith("broken.csv")
    assert "not judged" in lines[1]
    assert lines[2].split()[:2] == ["shifted.csv", "explained"]
    assert lines[2].split()[3] == "phase_offset"
    assert said.err == "usmbench: 1 of 4 runs were not judged; their lines say why\n"


def test_a_cluster_finds_what_one_by_one_is_found(
    folder: Path, one_by_one: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    with LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0"
    ) as cluster:
        assert_as_one_by_one(["--scheduler", cluster.scheduler_address], one_by_one)


def test_json_alone_on_standard_output(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    words = ["as-simulated.csv", "--model", "model.yaml", "--json", "-"]
    assert main(["diagnose", *words, "--each"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)["runs"]
    assert entry["verdict"] == "no_discrepancy"


def refused(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one line with which a command on good runs is refused."""
    assert main(["diagnose", "shifted.csv", "--model", "model.yaml", *words]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    return said


@pytest.mark.parametrize(
    ("option", "value"),
    [("--out", "x.yaml"), ("--report", "x.html"), ("--next", "x.yaml"), ("--bench", "simulated")],
)
def test_what_is_for_one_diagnosis_is_refused(
    option: str,
    value: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(folder)
    assert f"{option} is for one diagnosis" in refused(["--each", option, value], capsys)


def test_a_scheduler_that_is_none_is_refused(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setattr(executors, "_DEADLINE_S", 0.5)
    with create_server(("127.0.0.1", 0)) as silent:
        address = f"127.0.0.1:{silent.getsockname()[1]}"
        said = refused(["--scheduler", address], capsys)
    assert f"no Dask scheduler answers at {address} within 0.5 s (silent); give" in said
    assert "no Dask scheduler answers at nowhere" in refused(["--scheduler", "nowhere"], capsys)


def test_a_scheduler_without_workers_is_refused(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    with LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address="127.0.0.1:0") as cluster:
        words = ["--scheduler", cluster.scheduler_address]
        assert "has no workers; start some: dask worker" in refused(words, capsys)


def test_without_dask_the_extra_is_named(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert "usmbench[cluster]" in refused(["--scheduler", "127.0.0.1:8786"], capsys)


class Unwell(Executor):
    """Its first worker is killed, its second never takes up its run."""

    def __init__(self) -> None:
        self.n_taken = 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        if self.n_taken == 0:
            future.set_exception(MemoryError("in\nlines"))
        self.n_taken += 1
        return future


def test_a_lost_worker_costs_its_own_run_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(each_run, "_SILENT_S", 0.05)
    found = dict(each_run.diagnose_each([Path("a"), Path("b")], motor(), Unwell()))
    assert found[0] == {"run": "a", "error": "its worker failed (MemoryError: in�lines)"}
    assert found[1]["run"] == "b"
    assert "nothing was done for 0.05 s" in found[1]["error"]


def test_a_stuck_worker_is_told_of_and_ended(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setattr(each_run, "_SILENT_S", 4.0)
    monkeypatch.setattr(each_run, "_diagnosed", stuck)
    Path("stuck.csv").touch()
    words = ["stuck.csv", "--model", "model.yaml", "--each"]
    assert main(["diagnose", *words]) == 2
    assert "nothing was done for 4 s" in capsys.readouterr().out
    deadline_s = time.monotonic() + 10.0
    while active_children():
        assert time.monotonic() < deadline_s
        time.sleep(0.01)


def test_a_worker_with_another_version_is_named(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(each_run, "__version__", "99.0")
    with executors.all_cores() as pool:
        ((_, entry),) = each_run.diagnose_each([folder / "shifted.csv"], motor(), pool)
    assert entry["error"].endswith("install 99.0 there")


def test_a_warning_names_its_run_once() -> None:
    entries: list[each_run.Entry] = [
        {"run": "a", "warnings": ["a: it changed", "its angle is that of the counter"]},
        {"run": "b", "error": "none"},
    ]
    said = list(each_run.each_warnings(entries))
    assert said == ["a: it changed", "a: its angle is that of the counter"]
