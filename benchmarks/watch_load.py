"""What the live page costs while it follows a run of 100 windows a second for ten minutes.

    python benchmarks/watch_load.py [--small] [--browser chromium] [--seconds 600]

A run folder grows row by row; `usmbench watch` serves it, with a model of degree 18 beside it, from
a process of its own whose CPU time and memory are read from /proc (Linux). The page's part is
played by a client that asks as often as the page does, or by the page itself in a browser, whose
main thread and script memory are then printed as well. Exit status 1 where the server takes 5 % of
a core or its memory grows by more than 2 % over the second half.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path

import numpy as np

from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.model_file import write_model
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import PairRow, WindowRow

WINDOW_S = 0.01
DWELL_WINDOWS = 50
POLL_S = 1.0
SAMPLE_S = 5.0
GOAL_SHARE, GOAL_GROWTH = 0.05, 0.02
META = {"encoder": {"counts_per_rev": 2000, "sample_rate_hz": 1e5, "samples_per_average": 1000}}
PHASES_DEG = np.r_[-90:91:5, 90:-91:-5].astype(float)


@dataclass(frozen=True)
class Load:
    """What a process has taken so far."""

    at_s: float
    cpu_s: float
    memory_mb: float


def load_of(pid: int) -> Load:
    """Read a process's CPU time and resident memory."""
    ticks = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    cpu_s = (int(ticks[11]) + int(ticks[12])) / os.sysconf("SC_CLK_TCK")
    return Load(time.monotonic(), cpu_s, pages * os.sysconf("SC_PAGE_SIZE") / 1e6)


def browser_cpu_s() -> float:
    """Return the CPU time of every process that a browser below this one has."""
    below = {os.getpid()}
    stats = {int(path.parent.name): path for path in Path("/proc").glob("[0-9]*/stat")}
    cpu_s = 0.0
    for pid in sorted(stats):
        with suppress(OSError):
            name, _, words = stats[pid].read_text().rpartition(")")
            if int(words.split()[1]) in below:
                below.add(pid)
                cpu_s += load_of(pid).cpu_s if "chrom" in name else 0.0
    return cpu_s


def speed_rad_s(phase_deg: float) -> float:
    """Return the speed of a motor without dead zone."""
    return float(10.25 * np.sin(np.radians(phase_deg)))


def write_a_model(path: Path) -> None:
    """Write the model that is shown beside the run."""
    knots_deg = np.linspace(-90.0, 90.0, 19)
    curve = StaticCurve(knots_deg, 10.25 * np.sin(np.radians(knots_deg)))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (None, None), 0.05)
    linear = LinearPart(np.array([-0.06]), np.array([0.9, 0.04]), 0, WINDOW_S)
    write_model(path, HammersteinModel(linear, (point,), "fast"))


class Bench:
    """Appends the windows that are due, and a pair a dwell."""

    def __init__(self, writer: RunWriter):
        self.writer = writer
        self.begun_s = time.monotonic()
        self.n_windows = 0
        self.noise_rad_s = np.random.default_rng(1).normal(0.0, 0.05, 4096)

    def write_what_is_due(self) -> None:
        """Catch up with the clock on the wall."""
        while self.n_windows * WINDOW_S < time.monotonic() - self.begun_s:
            dwell, into = divmod(self.n_windows, DWELL_WINDOWS)
            number, place = divmod(dwell, len(PHASES_DEG))
            phase_deg = float(PHASES_DEG[place])
            self.n_windows += 1
            t_s = self.n_windows * WINDOW_S
            speed = speed_rad_s(phase_deg) + float(self.noise_rad_s[self.n_windows % 4096])
            angle_rad = speed * t_s
            self.writer.window(
                WindowRow(
                    t_s, phase_deg, speed, 41e3, 0.0, angle_rad, WINDOW_S, number, 1, speed, 1
                )
            )
            if into == DWELL_WINDOWS - 1:
                direction = 1 if place < len(PHASES_DEG) // 2 else -1
                self.writer.pair(
                    PairRow(phase_deg, 41e3, 0.0, speed, 0.05, 40, direction, t_s, dwell, 1)
                )


@contextmanager
def asking(port: int) -> Iterator[Callable[[], None]]:
    """Ask for the state as often as the page does."""
    connection = HTTPConnection("127.0.0.1", port, timeout=10.0)
    next_s = 0.0

    def ask() -> None:
        nonlocal next_s
        if time.monotonic() < next_s:
            return
        next_s = time.monotonic() + POLL_S
        connection.request("GET", "/state?span=whole")
        connection.getresponse().read()

    yield ask
    connection.close()


@contextmanager
def browsing(port: int, browser: str) -> Iterator[Callable[[], None]]:
    """Have the page itself ask, and print what it took at the end."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
        chromium = playwright.chromium.launch(executable_path=browser, args=arguments)
        page = chromium.new_page(viewport={"width": 1280, "height": 900})
        page.goto(f"http://127.0.0.1:{port}/")
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable")

        def metrics() -> dict[str, float]:
            session.send("HeapProfiler.collectGarbage")
            found = session.send("Performance.getMetrics")["metrics"]
            return {one["name"]: one["value"] for one in found}

        page.wait_for_timeout(3000)
        first, begun_s, begun_cpu_s = metrics(), time.monotonic(), browser_cpu_s()
        yield lambda: page.wait_for_timeout(1)
        last, took_s = metrics(), time.monotonic() - begun_s
        cpu_s = browser_cpu_s() - begun_cpu_s
        print(f"browser             {100 * cpu_s / took_s:.1f} % of a core, all its processes")
        share = (last["TaskDuration"] - first["TaskDuration"]) / took_s
        print(f"page's main thread  {100 * share:.1f} % of a core")
        heaps = [one["JSHeapUsedSize"] / 1e6 for one in (first, last)]
        print(f"page's script heap  {heaps[0]:.2f} MB at first, {heaps[1]:.2f} MB at last")
        chromium.close()


def follow(folder: Path, seconds: float, browser: str | None) -> list[Load]:
    """Write a run for so long while its page is served; return what the server took over time."""
    model = folder / "model.yaml"
    write_a_model(model)
    bench = Bench(RunWriter.create(folder / "run", META, temperature=False, raw=False))
    command = [
        sys.executable,
        "-m",
        "usmbench",
        "watch",
        str(folder / "run"),
        "--model",
        str(model),
    ]
    loads: list[Load] = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            said = re.search(r":(\d+)/", server.stdout.readline() if server.stdout else "")
            if said is None:
                raise SystemExit("usmbench watch did not start")
            port = int(said[1])
            with browsing(port, browser) if browser else asking(port) as ask:
                end_s = time.monotonic() + seconds
                while time.monotonic() < end_s:
                    bench.write_what_is_due()
                    ask()
                    if not loads or time.monotonic() >= loads[-1].at_s + min(SAMPLE_S, seconds / 8):
                        loads.append(load_of(server.pid))
                    time.sleep(WINDOW_S)
                loads.append(load_of(server.pid))
        finally:
            server.kill()
            bench.writer.close("completed")
    print(f"windows written     {bench.n_windows} in {loads[-1].at_s - bench.begun_s:.0f} s")
    return loads


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--small", action="store_true", help="eight seconds")
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--browser", metavar="PROGRAM", help="have the page asked by this browser")
    args = parser.parse_args()
    seconds = 8.0 if args.small else args.seconds
    with tempfile.TemporaryDirectory() as folder:
        loads = follow(Path(folder), seconds, args.browser)
    first, middle, last = loads[0], loads[len(loads) // 2], loads[-1]
    share = (last.cpu_s - first.cpu_s) / (last.at_s - first.at_s)
    growth = last.memory_mb / middle.memory_mb - 1.0
    print(f"server              {100 * share:.2f} % of a core; goal {100 * GOAL_SHARE:g} %")
    print(
        f"server's memory     {first.memory_mb:.1f} MB at first, {middle.memory_mb:.1f} MB half "
        f"way, {last.memory_mb:.1f} MB at last; goal {100 * GOAL_GROWTH:g} % over the second half"
    )
    return int(share >= GOAL_SHARE or growth > GOAL_GROWTH)


if __name__ == "__main__":
    sys.exit(main())
