"""The sweep through the real driver, frame codec, board, motor and encoder, in this process."""

import csv
from collections.abc import Iterable
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest

from hil_sim.faults import Fault, FaultKind
from hil_sim.in_process import InProcessBench
from usmbench.cli.bench_session import Bench
from usmbench.cli.recorded_commands import recorded_dwells
from usmbench.cli.sweep_run import sweep_again, sweep_new
from usmbench.errors import BenchError, InputError
from usmbench.instruments.generator import SignalGenerator
from usmbench.runs.meta import read_meta
from usmbench.runs.reader import read_run
from usmbench.runs.stop_request import STOP_FILE, request_stop
from usmbench.settings.bench import BenchSettings, TemperatureSettings
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import Source
from usmbench.sweep.observer import Standing
from usmbench.sweep.rows import PairRow, WindowRow

SETTINGS = BenchSettings()


class SimulatedLoad:
    """The operator of a simulated bench."""

    def __init__(self, simulated: InProcessBench):
        self.simulated = simulated

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        self.simulated.set_load(torque_nm)

    def load_is_set(self) -> bool:
        return True


def bench_of(
    faults: Iterable[Fault] = (), settings: BenchSettings = SETTINGS
) -> tuple[InProcessBench, Bench]:
    temperature = settings.temperature is not None
    simulated = InProcessBench(3, faults=faults, temperature=temperature)
    generator = SignalGenerator(
        simulated.port,
        clock=simulated.clock,
        frequency_limits_hz=settings.generator.frequency_limits_hz,
        phase_limits_deg=settings.generator.phase_limits_deg,
    )
    operator = SimulatedLoad(simulated)
    return simulated, Bench(settings, generator, simulated.source, operator, simulated.clock)


def plan_of(**keys: object) -> Plan:
    document: dict[str, object] = {
        "format": "usmbench-plan/1",
        "name": "short",
        "frequency_hz": 41000,
        "warm_up": {"phase_deg": 90, "duration_s": 0.1},
        "passes": [{"phase_deg": {"from": -90, "to": 90, "step": 60}, "direction": "both"}],
        "dwell": {"windows": 20, "settle": {"min_windows": 3, "over_windows": 6}},
    }
    if "excitation" in keys:
        del document["passes"]
    return parse_plan(Source("plan.yaml", document | keys))


def rows(file: Path) -> list[dict[str, float]]:
    with file.open(newline="") as lines:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(lines)]


class StopAfter:
    """A user who presses Ctrl-C once so many windows have been measured."""

    def __init__(self, windows: int):
        self.left = windows

    def window(self, row: WindowRow, standing: Standing) -> None:
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt

    def settled(self, pair: PairRow) -> None:
        """Let every pair pass."""


def test_a_sweep_gives_a_run_folder_as_the_contract_has_it(tmp_path: Path) -> None:
    settings = replace(SETTINGS, temperature=TemperatureSettings("ai0"))
    _, bench = bench_of(settings=settings)
    sweep_new(bench, plan_of(), tmp_path / "run", raw=True, meta={"seed": 3})
    meta = read_meta(tmp_path / "run")
    assert (meta["exit"], meta["seed"], meta["plan"]["name"]) == ("completed", 3, "short")
    assert meta["encoder"]["counts_per_rev"] == 2000
    assert meta["generator"] == {"phase_step_deg": 360.0 / 4096.0}
    pairs = rows(tmp_path / "run" / "pairs.csv")
    assert [pair["phase_deg"] for pair in pairs] == [-90, -30, 30, 90, 90, 30, -30, -90]
    assert [pair["direction"] for pair in pairs] == [1, 1, 1, 1, -1, -1, -1, -1]
    speeds = [pair["speed_rad_s"] for pair in pairs]
    assert speeds[:4] == sorted(speeds[:4])
    # The paper's motor runs at about 10.25 rad/s at full phase.
    assert speeds[3] == pytest.approx(10.25, rel=0.05)
    assert "temperature_c" in rows(tmp_path / "run" / "windows.csv")[0]
    assert (tmp_path / "run" / "raw.h5").exists()
    assert not bench.generator.outputs_on


def dwells(folder: Path) -> list[tuple[float, ...]]:
    keys = ("dwell", "phase_deg", "frequency_hz", "torque_nm", "direction", "n_windows", "settled")
    return [tuple(pair[key] for key in keys) for pair in rows(folder / "pairs.csv")]


@pytest.mark.parametrize(("rested_s", "least_s"), [(0.0, 0.01), (3600.0, 3600.0)])
def test_time_goes_on_by_the_pause(tmp_path: Path, rested_s: float, least_s: float) -> None:
    plan, folder = plan_of(passes=[{"phase_deg": [30, 60, 90]}]), tmp_path / "run"
    with pytest.raises(KeyboardInterrupt):
        sweep_new(bench_of()[1], plan, folder, observer=StopAfter(60))
    before = len(rows(folder / "windows.csv"))
    sweep_again(replace(bench_of()[1], rested_s=rested_s), plan, folder)
    t_s = [row["t_s"] for row in rows(folder / "windows.csv")]
    # Simulated, the run is ahead of the wall clock.
    assert t_s[before] - t_s[before - 1] >= least_s + 0.01 - 1e-9
    assert t_s[before] - t_s[before - 1] < least_s + 60.0


@pytest.mark.parametrize("stops", [[30], [60, 70], [5]])
def test_a_run_taken_up_has_the_dwells_of_one_that_was_never_stopped(
    tmp_path: Path, stops: list[int]
) -> None:
    plan = plan_of(torque_nm=[0, 0.1], load="operator", passes=[{"phase_deg": [30, 60, 90]}])
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    sweep_new(bench_of()[1], plan, whole)
    _, bench = bench_of()
    with pytest.raises(KeyboardInterrupt):
        sweep_new(bench, plan, parts, observer=StopAfter(stops[0]))
    assert not bench.generator.outputs_on
    for stop in stops[1:]:
        with pytest.raises(KeyboardInterrupt):
            sweep_again(bench_of()[1], plan, parts, observer=StopAfter(stop))
    assert read_meta(parts)["exit"] == "interrupted"
    sweep_again(bench_of()[1], plan, parts)
    assert dwells(parts) == dwells(whole)
    assert read_meta(parts)["exit"] == "completed"
    t_s = [row["t_s"] for row in rows(parts / "windows.csv")]
    assert t_s == sorted(set(t_s))
    with pytest.raises(InputError, match="complete"):
        sweep_again(bench_of()[1], plan, parts)


@pytest.mark.parametrize("changed", [{"passes": [{"phase_deg": [30, 45]}]}, {"torque_nm": 0.1}])
def test_a_run_goes_on_by_its_own_plan_only(tmp_path: Path, changed: dict[str, Any]) -> None:
    """Whoever edits the plan in run.yaml is told so, and the folder stays as it was."""
    folder, passes = tmp_path / "run", [{"phase_deg": [30, 60, 90]}]
    with pytest.raises(KeyboardInterrupt):
        sweep_new(bench_of()[1], plan_of(passes=passes), folder, observer=StopAfter(65))
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    simulated, bench = bench_of()
    with pytest.raises(InputError, match="put the plan back") as refused:
        sweep_again(bench, plan_of(**{"passes": passes} | changed), folder)
    assert "run.yaml" in str(refused.value)
    assert simulated.source.samples_acquired() == 0
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before
    sweep_again(bench, plan_of(passes=passes), folder)


@pytest.mark.parametrize("stop", [40, 70, 90])
def test_the_commands_of_a_run_that_was_paused_are_those_of_its_plan(
    tmp_path: Path, stop: int
) -> None:
    plan = plan_of(passes=[{"phase_deg": [30, 60, 90], "direction": "both"}])
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    sweep_new(bench_of()[1], plan, whole)
    with pytest.raises(KeyboardInterrupt):
        sweep_new(bench_of()[1], plan, parts, observer=StopAfter(stop))
    sweep_again(bench_of()[1], plan, parts)
    planned = [(phase_deg, way) for _, phase_deg, _, _, way, *_ in dwells(whole)]
    for folder in (whole, parts):
        again = recorded_dwells(read_run(folder), SETTINGS.window_s)
        driven = [(d.phase_deg, float(d.direction)) for d in again if d.number >= 0]
        # A dwell that was cut short is driven twice.
        assert [one for one, _ in groupby(driven)] == planned


@pytest.mark.parametrize("torn", ["", "phase_deg,fre"])
def test_a_run_whose_pairs_were_cut_before_their_first_row_goes_on(
    tmp_path: Path, torn: str
) -> None:
    plan, folder = plan_of(passes=[{"phase_deg": [30, 60]}]), tmp_path / "run"
    with pytest.raises(KeyboardInterrupt):
        sweep_new(bench_of()[1], plan, folder, observer=StopAfter(5))
    (folder / "pairs.csv").write_text(torn)
    sweep_again(bench_of()[1], plan, folder)
    assert [pair["phase_deg"] for pair in rows(folder / "pairs.csv")] == [30, 60]


class AskToStop(StopAfter):
    """Somebody at another process who wants to stop once so many windows have been measured."""

    def __init__(self, windows: int, folder: Path):
        super().__init__(windows)
        self.folder = folder

    def window(self, row: WindowRow, standing: Standing) -> None:
        self.left -= 1
        if self.left == 0:
            request_stop(self.folder)


def test_a_stop_request_switches_off_and_is_forgotten_when_the_run_is_taken_up(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "run"
    plan = plan_of(passes=[{"phase_deg": [90]}], dwell={"windows": 20_000})
    _, bench = bench_of()
    with pytest.raises(KeyboardInterrupt, match="stop request"):
        sweep_new(bench, plan, folder, observer=AskToStop(30, folder))
    assert not bench.generator.outputs_on
    assert read_meta(folder)["exit"] == "interrupted"
    assert not (folder / STOP_FILE).exists()
    # One that came when nobody was left to take it must not stop the next.
    request_stop(folder)
    _, bench = bench_of()
    with pytest.raises(KeyboardInterrupt) as stopped:
        sweep_again(bench, plan, folder, observer=StopAfter(30))
    assert not stopped.value.args


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        (FaultKind.SLIPPED_COUPLING, "coupling"),
        (FaultKind.DEAD_CHANNEL, "one encoder channel is dead"),
        (FaultKind.BOARD_RESET, "restarted"),
        (FaultKind.DAQ_OVERFLOW, "overw"),
        (FaultKind.EVENT_STREAM_DEAD, "no samples"),
        (FaultKind.PORT_GONE, "port"),
    ],
)
def test_a_fault_stops_the_drive_and_is_named(tmp_path: Path, kind: FaultKind, words: str) -> None:
    _, bench = bench_of([Fault(kind, 0.6)])
    plan = plan_of(passes=[{"phase_deg": [90]}], dwell={"windows": 300})
    with pytest.raises(BenchError, match=words), bench.generator:
        sweep_new(bench, plan, tmp_path / "run")
    assert read_meta(tmp_path / "run")["exit"].startswith("failed: ")
    last_s = rows(tmp_path / "run" / "windows.csv")[-1]["t_s"]
    assert 0.5 <= last_s <= 0.6 + 1.1


def test_a_slipped_coupling_ends_a_multisine_too(tmp_path: Path) -> None:
    _, bench = bench_of([Fault(FaultKind.SLIPPED_COUPLING, 3.0)])
    multisine = {"kind": "multisine", "seed": 1, "amplitude_deg": 90, "hold_windows": 4}
    excitation = {**multisine, "band_hz": [0.05, 5], "period_s": 20, "duration_s": 20}
    with pytest.raises(BenchError, match="no motion"), bench.generator:
        sweep_new(bench, plan_of(excitation=excitation), tmp_path / "run")
    last_s = rows(tmp_path / "run" / "windows.csv")[-1]["t_s"]
    assert 3.5 <= last_s <= 6.0


def test_a_plan_beyond_the_board_leaves_no_folder(tmp_path: Path) -> None:
    _, bench = bench_of()
    with pytest.raises(InputError, match="frequency_hz"):
        sweep_new(bench, plan_of(frequency_hz=43000), tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_folder_that_exists_is_left_alone(tmp_path: Path) -> None:
    simulated, bench = bench_of()
    with pytest.raises(InputError, match="exists already"):
        sweep_new(bench, plan_of(), tmp_path)
    assert simulated.source.samples_acquired() == 0


def test_free_excitation(tmp_path: Path) -> None:
    excitation: dict[str, Any] = {
        "kind": "multisine",
        "amplitude_deg": 90,
        "duration_s": 1.0,
        "hold_windows": 5,
    }
    plan = plan_of(excitation=excitation)
    _, bench = bench_of()
    sweep_new(bench, plan, tmp_path / "run")
    windows = rows(tmp_path / "run" / "windows.csv")
    assert len({row["phase_deg"] for row in windows if row["settled"]}) == 20
    assert len(rows(tmp_path / "run" / "pairs.csv")) == 20
