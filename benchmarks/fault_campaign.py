"""Draw a fault and an instant, sweep, and hold what happened against what must happen.

    python benchmarks/fault_campaign.py [--draws 500] [--seed 1] [--through-wire 50] [--small]

The first draws go through the pseudo-terminal and the NI device server, the others run in process.
For every draw: the drive is off in time, no row that was reported is lost, the exit status is
right, and the message names the fault. Exit status 1 if any draw fails.
"""

import argparse
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import yaml

from benchmarks.in_process_bench import in_process_bench
from hil_sim.fault_entries import random_fault
from hil_sim.faults import BYTE_KINDS, Fault, FaultKind, FaultSchedule
from hil_sim.plant import MotorPlant
from hil_sim.running import RunningTestbed
from hil_sim.testbed import Testbed
from usmbench.cli.bench_session import Bench, open_bench
from usmbench.cli.simulated_bench import simulated_settings
from usmbench.cli.sweep_run import sweep_new
from usmbench.errors import UsmbenchError
from usmbench.runs.catalogue import changed_data
from usmbench.runs.meta import read_meta
from usmbench.runs.reader import read_run
from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan_file import parse_plan
from usmbench.settings.yaml_source import Source
from usmbench.sweep.observer import Standing
from usmbench.sweep.rows import PairRow, WindowRow

OpenBench = Callable[[], AbstractContextManager[Bench]]

DRIVE_OFF_WITHIN_S = 1.1
# Over the wire silence is waited for in real seconds, on a machine that may be busy.
WIRE_SILENCE_S = 2.0
# The plan below, with its rests.
DURATION_S = 6.0
PLAN = """
format: usmbench-plan/1
name: fault-campaign
frequency_hz: 41000
torque_nm: 0
passes:
  - {phase_deg: [-90, -60, -30, 30, 60, 90, 60, 5, -90], direction: as_listed}
dwell: {windows: 60, settle: {min_windows: 5, over_windows: 4}}
"""
# Phases at which the motor must move whatever the run has shown (no_motion_phase_deg).
SURE_TO_MOVE_DEG = 85.0
# Faults that the chain has to ride out, and those that only motion can show.
HARMLESS = {*BYTE_KINDS, FaultKind.COUNTER_WRAP}
SEEN_BY_MOTION = {FaultKind.DEAD_CHANNEL, FaultKind.SLIPPED_COUPLING}
NAMED_BY = {
    FaultKind.BOARD_RESET: r"restarted|reset",
    FaultKind.BOARD_SILENT: r"did not answer|silence",
    FaultKind.PORT_GONE: r"port|gone",
    FaultKind.DAQ_OVERFLOW: r"overwr|overflow",
    FaultKind.EVENT_STREAM_DEAD: r"no (samples|data)",
    FaultKind.SERVER_DEAD: r"server",
    FaultKind.DEAD_CHANNEL: r"channel",
    FaultKind.SLIPPED_COUPLING: r"coupling",
}


@dataclass
class Outcome:
    """What one draw did."""

    fault: Fault
    status: int = 0
    message: str = ""
    off_after_s: float = 0.0
    complaints: list[str] = field(default_factory=list)


class Reported:
    """Counts the rows that the sweep has reported."""

    def __init__(self) -> None:
        self.rows: list[WindowRow] = []

    def window(self, row: WindowRow, standing: Standing) -> None:
        """Take one window."""
        self.rows.append(row)

    def settled(self, pair: PairRow) -> None:
        """Let every pair pass."""


def drive_off_s(testbed: Testbed) -> float:
    """Return since when the drive has been off; inf while it is on."""
    off_s = 0.0
    for time_s, drive in testbed.drive_history:
        on = drive.amplitude_a > 0 or drive.amplitude_b > 0
        off_s = inf if on else (time_s if off_s == inf else off_s)
    return off_s


def seen_from_s(fault: Fault, rows: Iterable[WindowRow], end_s: float) -> float:
    """Return from when a fault can be seen: motion faults need half a second of sure motion."""
    if fault.kind not in SEEN_BY_MOTION:
        return fault.time_s
    begun_s = inf
    for row in rows:
        if not row.drive_on or abs(row.phase_deg) < SURE_TO_MOVE_DEG:
            begun_s = inf
            continue
        begun_s = min(begun_s, max(fault.time_s, row.t_s - row.window_s))
        if row.t_s - begun_s >= 0.5:
            return begun_s
    return end_s


def judge(outcome: Outcome, testbed: Testbed, reported: Reported, folder: Path) -> None:
    """Write down what is wrong with a draw."""
    fault, complaints = outcome.fault, outcome.complaints
    testbed.idle(1.5)
    off_s = drive_off_s(testbed)
    outcome.off_after_s = off_s - seen_from_s(fault, reported.rows, testbed.time_s)
    if fault.kind in HARMLESS:
        if outcome.status:
            complaints.append(f"exit status {outcome.status} though it can be ridden out")
        if off_s == inf:
            complaints.append("drive left on")
    elif outcome.off_after_s > DRIVE_OFF_WITHIN_S:
        complaints.append(f"drive off only after {outcome.off_after_s:.2f} s")
    elif outcome.status == 0 and outcome.off_after_s > 0:
        complaints.append("exit status 0 though the drive was on when it struck")
    if outcome.status not in (0, 3):
        complaints.append(f"exit status {outcome.status}")
    if outcome.status and not re.search(NAMED_BY.get(fault.kind, "^$"), outcome.message):
        complaints.append(f"the message does not name the fault: {outcome.message}")
    complaints.extend(_folder_complaints(outcome, reported, folder))


def _folder_complaints(outcome: Outcome, reported: Reported, folder: Path) -> Iterable[str]:
    """Yield what is wrong with the run folder."""
    if not reported.rows:
        return
    kept = read_run(folder).t_s
    if len(kept) < len(reported.rows):
        yield f"{len(reported.rows) - len(kept)} reported rows are lost"
    elif not np.allclose(kept[: len(reported.rows)], [row.t_s for row in reported.rows]):
        yield "the rows kept are not those reported"
    said = str(read_meta(folder).get("exit"))
    wanted = "failed: " if outcome.status else "completed"
    if not said.startswith(wanted):
        yield f"run.yaml says exit: {said}"
    if changed_data(folder):
        yield "a sha256 does not match"


@contextmanager
def open_testbed(fault: Fault, seed: int, wire: bool) -> Iterator[tuple[Testbed, OpenBench]]:
    """Start a testbed, and tell how to open its bench."""
    if not wire:
        bench = in_process_bench(seed, faults=[fault])
        yield bench.testbed, bench.opened
        return
    with RunningTestbed(MotorPlant(seed=seed), FaultSchedule([fault]), lock_step=True) as running:
        settings = simulated_settings(BenchSettings(), running.port, running.daq_address)
        daq = replace(settings.daq, no_data_timeout_s=WIRE_SILENCE_S)
        yield running.testbed, partial(open_bench, replace(settings, daq=daq))


def run_draw(number: int, *, seed: int, through_wire: int) -> Outcome:
    """Run one draw in a folder of its own."""
    rng = np.random.default_rng([seed, number])
    fault = random_fault(rng, DURATION_S)
    outcome, reported = Outcome(fault), Reported()
    plan = parse_plan(Source("fault campaign", yaml.safe_load(PLAN)))
    motor_seed = int(rng.integers(2**31))
    with (
        tempfile.TemporaryDirectory() as parent,
        open_testbed(fault, motor_seed, number < through_wire) as (testbed, opened),
    ):
        folder = Path(parent) / "run"
        try:
            with opened() as bench:
                sweep_new(bench, plan, folder, observer=reported)
        except UsmbenchError as error:
            outcome.status = error.exit_status
            outcome.message = "; ".join([str(error), *getattr(error, "__notes__", [])])
        judge(outcome, testbed, reported, folder)
    return outcome


def table(outcomes: list[Outcome]) -> str:
    """Return what came out, a line a kind."""
    lines = [f"{'fault':<20}{'draws':>6}{'stopped':>9}{'latest drive off (s)':>22}{'failed':>8}"]
    for kind in FaultKind:
        ours = [outcome for outcome in outcomes if outcome.fault.kind is kind]
        stopped = [o.off_after_s for o in ours if o.status]
        latest = f"{max(stopped):.2f}" if stopped else "-"
        failed = sum(bool(o.complaints) for o in ours)
        lines.append(f"{kind:<20}{len(ours):>6}{len(stopped):>9}{latest:>22}{failed:>8}")
    return "\n".join(lines)


def campaign(draws: int, seed: int, jobs: int, through_wire: int) -> list[Outcome]:
    """Run all draws."""
    draw = partial(run_draw, seed=seed, through_wire=through_wire)
    if jobs == 1:
        return [draw(number) for number in range(draws)]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        return list(pool.map(draw, range(draws), chunksize=8))


def main() -> int:
    """Run the campaign and print its table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--draws", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--through-wire", type=int, default=50, metavar="N")
    parser.add_argument("--small", action="store_true", help="26 draws, 6 of them over the wire")
    arguments = parser.parse_args()
    draws, through_wire = arguments.draws, arguments.through_wire
    if arguments.small:
        draws, through_wire = 26, 6
    outcomes = campaign(draws, arguments.seed, arguments.jobs, through_wire)
    print(table(outcomes))
    failed = [(number, outcome) for number, outcome in enumerate(outcomes) if outcome.complaints]
    for number, outcome in failed:
        print(f"draw {number}: {outcome.fault.kind}@{outcome.fault.time_s:.3f}: ", end="")
        print("; ".join(outcome.complaints))
    counted = Counter(outcome.status for outcome in outcomes)
    print(f"{draws} draws, {len(failed)} failed; exit statuses {dict(sorted(counted.items()))}")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
