"""What a sweep in real time costs beyond its dwells, beside bluesky's RunEngine on its own devices.

    python benchmarks/real_time_sweep.py [--small] [--panel]

`--panel` shows the sweep on a terminal of its own, as `usmbench sweep` does in one. The simulated
testbed runs on the wall clock, its serial line at 115200 baud. Our overhead is the whole duration
of the sweep less the planned windows; bluesky's is the duration of a scan over the same points on
simulated devices that take no time. Exit status 1 beyond 1.02 × the planned time.
"""

import argparse
import fcntl
import os
import struct
import sys
import tempfile
import termios
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import replace
from pathlib import Path

from usmbench.cli.bench_session import open_bench
from usmbench.cli.live_panel import LivePanel
from usmbench.cli.simulated_bench import simulated_settings, start_testbed
from usmbench.cli.sweep_run import plan_job, sweep_new
from usmbench.settings.bench import BenchSettings, DaqSettings
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import load_plan
from usmbench.sweep.preflight import interlocks_of
from usmbench.sweep.schedule import schedule

GOAL = 1.02


@contextmanager
def panel_on_a_terminal(plan: Plan, settings: BenchSettings) -> Iterator[LivePanel]:
    """Show the sweep on a pseudo-terminal of 100 × 30 that nobody looks at."""
    master, slave = os.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
    os.environ["TERM"] = "xterm"

    def drain() -> None:
        with suppress(OSError):
            while os.read(master, 65536):
                pass

    reader = threading.Thread(target=drain)
    reader.start()
    with (
        os.fdopen(slave, "w") as stream,
        LivePanel(stream, plan.name, interlocks_of(plan, settings)) as panel,
    ):
        yield panel
    reader.join(5.0)
    os.close(master)


def sweep_once(plan: Plan, *, panel: bool = False) -> tuple[float, float, int]:
    """Return measured and planned duration in seconds, and the number of dwells."""
    with start_testbed(["--seed", "1"]) as testbed, tempfile.TemporaryDirectory() as parent:
        settings = simulated_settings(BenchSettings(), testbed.port, testbed.daq_address)
        usual = DaqSettings()
        daq = replace(settings.daq, no_data_timeout_s=usual.no_data_timeout_s)
        settings = replace(settings, daq=daq)
        shown = panel_on_a_terminal(plan, settings) if panel else nullcontext()
        with open_bench(settings) as bench, shown as observer:
            begun_s = time.perf_counter()
            sweep_new(bench, plan, Path(parent) / "run", observer=observer)
            took_s = time.perf_counter() - begun_s
    planned_s = plan_job(plan, settings).n_windows * settings.window_s
    dwells = sum(dwell.settle is not None for dwell in schedule(plan, settings.window_s))
    return took_s, planned_s, dwells


def bluesky_scan(points: int) -> float:
    """Return the duration in seconds of bluesky's scan over as many points."""
    from bluesky import RunEngine
    from bluesky.plans import scan
    from ophyd.sim import det, motor

    engine = RunEngine({})
    begun_s = time.perf_counter()
    engine(scan([det], motor, -90, 90, points))
    return time.perf_counter() - begun_s


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--small", action="store_true", help="short dwells")
    parser.add_argument("--panel", action="store_true", help="shown on a terminal")
    plan, args = load_plan("phase-sweep"), parser.parse_args()
    if args.small:
        plan = replace(plan, dwell=replace(plan.dwell, windows=16), warm_up=None)
    begun_cpu_s = time.process_time()
    took_s, planned_s, dwells = sweep_once(plan, panel=args.panel)
    cpu_share = (time.process_time() - begun_cpu_s) / took_s
    peer_s = bluesky_scan(dwells)
    print(f"usmbench: {took_s:.2f} s for {planned_s:.2f} s planned: {took_s / planned_s:.4f} ×")
    print(f"usmbench: {(took_s - planned_s) / dwells * 1e3:.2f} ms beyond the dwell, a point")
    print(f"usmbench: {100 * cpu_share:.1f} % of a core")
    print(f"bluesky:  {peer_s / dwells * 1e3:.2f} ms a point, devices that take no time")
    print(f"points:   {dwells}; goal {GOAL} ×")
    return int(took_s > GOAL * planned_s)


if __name__ == "__main__":
    sys.exit(main())
