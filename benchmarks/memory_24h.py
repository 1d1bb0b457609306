"""Whether memory stays flat over a simulated day of sweeping, in process.

    python benchmarks/memory_24h.py [--hours 24] [--small]

The shipped phase sweep is repeated until the hours are full, a window every 100 ms, through driver,
board, encoder and run folder. Resident memory is read after every twentieth of the
windows. Exit status 1 where the last three quarters add more than 5 % to it.
"""

import argparse
import sys
import tempfile
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

from benchmarks.in_process_bench import in_process_bench
from usmbench.cli.sweep_run import plan_job, sweep_new
from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import load_plan
from usmbench.sweep.observer import Standing
from usmbench.sweep.rows import PairRow, WindowRow

GOAL = 1.05
READINGS = 20
SETTLED = 5  # readings before memory is held against the goal


def resident_mb() -> float:
    """Return this process's resident memory; Linux only."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024.0
    raise AssertionError("Linux tells VmRSS of every process")


@dataclass
class MemoryReader:
    """Reads memory now and then while the sweep goes on."""

    every: int
    taken: int = 0
    read_mb: list[float] = field(default_factory=list)

    def window(self, row: WindowRow, standing: Standing) -> None:
        """Take one window."""
        self.taken += 1
        if self.taken % self.every == 0:
            self.read_mb.append(resident_mb())
            print(f"{row.t_s / 3600:7.3f} h  {self.read_mb[-1]:7.1f} MB", flush=True)

    def settled(self, pair: PairRow) -> None:
        """Take the pair of a dwell."""


def day_plan(hours: float, settings: BenchSettings) -> Plan:
    """Return the phase sweep, repeated until the hours are full."""
    plan = load_plan("phase-sweep")
    once = plan_job(plan, settings).n_windows * settings.window_s
    repeats = max(1, round(hours * 3600.0 / once))
    return replace(plan, passes=tuple(replace(p, repeats=repeats) for p in plan.passes))


def sweep_hours(hours: float) -> list[float]:
    """Sweep, and return the memory read on the way in MB."""
    settings = BenchSettings(name="simulated in process")
    daq = replace(settings.daq, sample_rate_hz=20_000.0, samples_per_average=2000)
    # A day of drive is what is asked here; the simulated motor does not mind.
    interlocks = replace(settings.interlocks, drive_time_max_s=2.0 * 86_400.0)
    settings = replace(settings, daq=daq, interlocks=interlocks)
    plan = day_plan(hours, settings)
    reader = MemoryReader(every=plan_job(plan, settings).n_windows // READINGS)
    with (
        tempfile.TemporaryDirectory() as parent,
        in_process_bench(1, settings=settings).opened() as bench,
    ):
        sweep_new(bench, plan, Path(parent) / "run", observer=reader)
    return reader.read_mb


def growth(read_mb: list[float]) -> float:
    """Return the largest later reading over the one where memory had settled."""
    return max(read_mb[SETTLED:]) / read_mb[SETTLED - 1]


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hours", type=float, default=24.0, help="simulated hours")
    parser.add_argument("--small", action="store_true", help="six simulated minutes")
    options = parser.parse_args()
    hours = 0.1 if options.small else options.hours
    begun_s = time.perf_counter()
    factor = growth(sweep_hours(hours))
    print(f"{hours:g} h simulated in {time.perf_counter() - begun_s:.0f} s")
    print(f"memory grew {factor:.3f} × from a quarter of the run to its end (goal {GOAL} ×)")
    return int(factor > GOAL)


if __name__ == "__main__":
    sys.exit(main())
