"""The encoder path: the real nidaqmx client on the stand-in server, in a process of its own.

Prints windows lost, the client's share of a core, how late callbacks are, how fast lock step is,
and the error of both speeds. Run as ``python benchmarks/encoder_path.py``; ``--small`` takes
seconds instead of minutes.
"""

import argparse
import json
import math
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hil_sim.faults import FaultSchedule
from hil_sim.ni_server import NiServer
from hil_sim.plant import MotorPlant
from hil_sim.signals import Drive, Samples
from usmbench.instruments.encoder import EncoderGeometry, EncoderState, decode
from usmbench.instruments.nidaq import NiSampleSource
from usmbench.settings.bench import DaqSettings

COUNTS_PER_REV = 2000
RAD_PER_COUNT = 2.0 * math.pi / COUNTS_PER_REV
BLOCK_S = 0.01
SPEEDS_RAD_S = (1.0, 3.0, 5.0, 10.25)
WARM_UP_BLOCKS = 20


class SteadyEncoder:
    """An ideal encoder at constant speed, so that every sample is known beforehand."""

    def __init__(self, speed_rad_s: float):
        self._counts_per_s = speed_rad_s / RAD_PER_COUNT
        self._taken = 0
        self._rate_hz = 1.0

    @property
    def time_s(self) -> float:
        """Simulated time of the end of the samples taken."""
        return self._taken / self._rate_hz

    def start(self) -> None:
        """Tell the client, on the same machine, when the first sample is taken."""
        print(json.dumps({"started_s": time.monotonic()}), flush=True)

    def stop(self) -> None:
        """Nothing goes on without a clock."""

    def acquire(self, n_samples: int, sample_rate_hz: float) -> Samples:
        """Take the next samples."""
        first, self._taken, self._rate_hz = self._taken, self._taken + n_samples, sample_rate_hz
        position = positions(first, n_samples, self._counts_per_s / sample_rate_hz)
        return Samples(position, position // COUNTS_PER_REV, 25.0)


class DrivenMotor(SteadyEncoder):
    """The simulated USR60 at full speed."""

    def __init__(self) -> None:
        super().__init__(0.0)
        self._plant = MotorPlant()
        self._plant.drive(0.0, Drive(41_000.0, 90.0, 1.0, 1.0))

    def acquire(self, n_samples: int, sample_rate_hz: float) -> Samples:
        """Take the next samples."""
        self._taken, self._rate_hz = self._taken + n_samples, sample_rate_hz
        return self._plant.sample(n_samples, sample_rate_hz)


def positions(first: int, n_samples: int, counts_per_sample: float) -> NDArray[np.int64]:
    samples = np.arange(first + 1, first + n_samples + 1)
    counts: NDArray[np.int64] = np.floor(samples * counts_per_sample).astype(np.int64)
    return counts


@dataclass(frozen=True)
class Setup:
    """One configuration of card and server."""

    rate_hz: float
    lock_step: bool
    index: bool = True
    speed_rad_s: float | None = 10.25  # None for the simulated motor

    def daq(self, address: str) -> DaqSettings:
        """Return the card's settings."""
        return DaqSettings(
            address=address,
            index_counter="ctr1" if self.index else None,
            sample_rate_hz=self.rate_hz,
            samples_per_average=round(self.rate_hz * BLOCK_S),
            no_data_timeout_s=5.0,
        )

    def __str__(self) -> str:
        motor = "motor" if self.speed_rad_s is None else "ideal"
        mode = "lock step" if self.lock_step else "real time"
        index = "encoder + index" if self.index else "encoder"
        return f"{self.rate_hz / 1e3:5.0f} kS/s  {mode}  {motor}  {index:15}"


def run_server(setup: Setup) -> None:
    feed = DrivenMotor() if setup.speed_rad_s is None else SteadyEncoder(setup.speed_rad_s)
    server = NiServer(feed, lock_step=setup.lock_step, faults=FaultSchedule())
    print(json.dumps({"address": server.address}), flush=True)
    sys.stdin.read()
    server.stop()


@contextmanager
def server_process(setup: Setup) -> Iterator["subprocess.Popen[str]"]:
    arguments = [sys.executable, __file__, "--serve", json.dumps(list(vars(setup).values()))]
    pipe = subprocess.PIPE
    with subprocess.Popen(arguments, stdin=pipe, stdout=pipe, text=True) as process:
        try:
            yield process
        finally:
            assert process.stdin is not None
            process.stdin.close()


def said(process: "subprocess.Popen[str]", key: str) -> str:
    assert process.stdout is not None
    return str(json.loads(process.stdout.readline())[key])


@dataclass(frozen=True)
class Result:
    """What one run showed; latencies are NaN in lock step, where blocks are never due."""

    n_blocks: int
    lost: int
    elapsed_s: float
    client_cpu_s: float
    latency_s: NDArray[np.float64]
    edge_timed_error: NDArray[np.float64]
    average_error: NDArray[np.float64]

    @property
    def blocks_per_s(self) -> float:
        """Windows a second, by the wall clock."""
        return self.n_blocks / self.elapsed_s

    @property
    def cpu_share(self) -> float:
        """The client's CPU time over the windows' time: its share of a core in real time."""
        return self.client_cpu_s / (self.n_blocks * BLOCK_S)


def measure(setup: Setup, n_blocks: int) -> Result:
    with server_process(setup) as process:
        daq = setup.daq(said(process, "address"))
        with NiSampleSource(daq) as source:
            return _take(setup, source, process, n_blocks)


def _take(
    setup: Setup, source: NiSampleSource, process: "subprocess.Popen[str]", n_blocks: int
) -> Result:
    n_samples = source.samples_per_block
    geometry = EncoderGeometry(COUNTS_PER_REV, source.counter_bits, 1, source.sample_rate_hz)
    state = EncoderState()
    ready_s = np.empty(n_blocks)
    lasts = np.empty(n_blocks, np.int64)
    speeds = np.empty((2, n_blocks))
    source.start()
    begin_s, begin_cpu_s = time.perf_counter(), time.process_time()
    for k in range(n_blocks):
        block = source.next_block()
        ready_s[k] = time.monotonic()
        state, motion = decode(state, block, geometry)  # raises where a block is missing
        lasts[k] = block.counts[-1]
        speeds[:, k] = motion.edge_timed_rad_s, motion.average_rad_s
    elapsed_s = time.perf_counter() - begin_s
    client_cpu_s = time.process_time() - begin_cpu_s
    due_s = float(said(process, "started_s")) + BLOCK_S * np.arange(1, n_blocks + 1)
    return Result(
        n_blocks,
        0 if setup.speed_rad_s is None else lost_blocks(lasts, n_samples, setup),
        elapsed_s,
        client_cpu_s,
        np.full(1, np.nan) if setup.lock_step else ready_s - due_s,
        *(relative_errors(speeds, setup)),
    )


def lost_blocks(lasts: NDArray[np.int64], n_samples: int, setup: Setup) -> int:
    """Return how many blocks did not end on the count that the encoder then had."""
    assert setup.speed_rad_s is not None
    counts_per_sample = setup.speed_rad_s / RAD_PER_COUNT / setup.rate_hz
    ends = np.arange(1, len(lasts) + 1) * n_samples
    expected = np.floor(ends * counts_per_sample).astype(np.int64)
    return int(np.count_nonzero(lasts != expected))


def relative_errors(speeds: NDArray[np.float64], setup: Setup) -> NDArray[np.float64]:
    if setup.speed_rad_s is None:
        return np.full((2, 1), np.nan)
    settled = speeds[:, WARM_UP_BLOCKS:]
    errors: NDArray[np.float64] = settled / setup.speed_rad_s - 1.0
    return errors


def rms_percent(errors: NDArray[np.float64]) -> float:
    return 100.0 * float(np.sqrt(np.mean(errors**2)))


def report_paths(lock_step_s: float, real_time_s: float) -> tuple[int, float]:
    """Print every setup; return the windows lost and the CPU share in lock step."""
    lost, cpu_share = 0, 0.0
    for rate_hz in (1e5, 1e6):
        for setup, duration_s in (
            (Setup(rate_hz, True), lock_step_s),
            (Setup(rate_hz, True, speed_rad_s=None), lock_step_s / 5),
            (Setup(rate_hz, False, index=False), real_time_s),
            (Setup(rate_hz, False), real_time_s),
        ):
            result = measure(setup, round(duration_s / BLOCK_S))
            lost += result.lost
            if setup.lock_step:
                cpu_share = max(cpu_share, result.cpu_share)
            print(
                f"{setup}  {result.n_blocks:6} windows  lost {result.lost}  {pace(setup, result)}",
                flush=True,
            )
    return lost, cpu_share


def pace(setup: Setup, result: Result) -> str:
    client = f"client {100 * result.cpu_share:.1f} % of a core at 100 windows/s"
    if setup.lock_step:
        return f"{client}, {result.blocks_per_s * BLOCK_S:.1f} x real time"
    late_ms = 1e3 * np.percentile(result.latency_s, (50, 99))
    return f"{client}, ready {late_ms[0]:.2f} ms after the window's end (p99 {late_ms[1]:.2f})"


def report_speeds(n_blocks: int) -> float:
    worst = 0.0
    for speed_rad_s in SPEEDS_RAD_S:
        result = measure(Setup(1e5, True, speed_rad_s=speed_rad_s), n_blocks)
        edge_timed = rms_percent(result.edge_timed_error)
        worst = max(worst, edge_timed)
        print(
            f"{speed_rad_s:5.2f} rad/s  rms error: edge_timed {edge_timed:.4f} %  "
            f"average {rms_percent(result.average_error):.3f} %",
            flush=True,
        )
    return worst


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="seconds instead of minutes")
    parser.add_argument("--serve", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.serve:
        rate_hz, lock_step, index, speed_rad_s = json.loads(options.serve)
        run_server(Setup(rate_hz, lock_step, index, speed_rad_s))
        return 0
    lost, cpu_share = report_paths(3.0, 1.0) if options.small else report_paths(600.0, 60.0)
    worst = report_speeds(100 if options.small else 2000)
    return 0 if lost == 0 and worst <= 0.05 and cpu_share <= 0.1 else 1


if __name__ == "__main__":
    sys.exit(main())
