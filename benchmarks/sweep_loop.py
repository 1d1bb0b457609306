"""What the sweep's own loop costs a window: rows, settling, interlocks, commands.

The same blocks pass through the controller, and through the encoder arithmetic alone; the
difference is the loop. Drive, disk and card cost nothing here. Run as
``python benchmarks/sweep_loop.py``; exits 1 above 40 µs of CPU time a window. ``--small`` takes
seconds.
"""

import argparse
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.instruments.encoder import EncoderGeometry, EncoderState, decode
from usmbench.instruments.samples import SampleBlock
from usmbench.settings.bench import BenchSettings, InterlockSettings
from usmbench.settings.plan import Settle
from usmbench.sweep.controller import Instruments, SweepController
from usmbench.sweep.observer import Standing
from usmbench.sweep.rows import PairRow, WindowRow
from usmbench.sweep.schedule import Dwell

ALLOWED_S = 40e-6
SAMPLES = 1000
RATE_HZ = 100_000.0
DWELL_WINDOWS = 50
SPEED_RAD_S = 9.0
BENCH = BenchSettings()
# The disc here turns whatever is commanded.
INTERLOCKS = replace(InterlockSettings(), motion_off_rad_s=100.0)


@dataclass
class FreeBench:
    """A disc at constant speed and a drive that takes every command at once."""

    blocks: NDArray[np.int64]
    phase_deg: float = 0.0
    outputs_on: bool = False
    read: int = 0
    sample_rate_hz: float = RATE_HZ
    samples_per_block: int = SAMPLES
    counter_bits: int = 32

    def set_drive(self, frequency_hz: float, phase_deg: float) -> None:
        """Take a command."""

    def heartbeat(self) -> None:
        """Take a sign of life."""

    def off(self) -> None:
        """Take the last command."""

    def start(self) -> None:
        """Start to turn."""

    def close(self) -> None:
        """Stop."""

    def next_block(self) -> SampleBlock:
        """Return the next block of those made beforehand, round and round."""
        turn, block = divmod(self.read, len(self.blocks))
        counts = self.blocks[block] + turn * int(self.blocks[-1, -1])
        self.read += 1
        return SampleBlock((self.read - 1) * SAMPLES, counts)

    def samples_acquired(self) -> int:
        """Return what was read: lock step."""
        return self.read * SAMPLES

    def set_load(self, torque_nm: float, *, ask: bool) -> None:
        """Take a load."""

    def load_is_set(self) -> bool:
        """Return that it is."""
        return True

    def window(self, row: WindowRow, standing: Standing | None = None) -> None:
        """Keep nothing."""

    def settled(self, pair: PairRow) -> None:
        """Keep nothing."""

    def pair(self, row: PairRow) -> None:
        """Keep nothing."""

    def raw(self, block: SampleBlock) -> None:
        """Keep nothing."""


def disc() -> NDArray[np.int64]:
    """Make a second of counter samples at constant speed, shape (100, 1000)."""
    counts_per_sample = SPEED_RAD_S / (2 * np.pi) * BENCH.counts_per_rev / RATE_HZ
    positions = np.floor(counts_per_sample * np.arange(1, 100 * SAMPLES + 1))
    counts: NDArray[np.int64] = positions.astype(np.int64)
    return counts.reshape(100, SAMPLES)


def dwells(n_windows: int) -> Iterator[Dwell]:
    """Yield dwells over a rising φ, one after another."""
    for number in range(n_windows // DWELL_WINDOWS):
        phase_deg = float(number % 180 - 90)
        yield Dwell(
            number, 0, phase_deg, 41_000.0, 0.0, 1, DWELL_WINDOWS, 4 * DWELL_WINDOWS, Settle()
        )


def loop_s(blocks: NDArray[np.int64], n_windows: int) -> tuple[float, int]:
    """Return the CPU time of a sweep and the number of its windows."""
    bench = FreeBench(blocks)
    instruments = Instruments(bench, bench, bench)
    controller = SweepController(instruments, BENCH, INTERLOCKS, bench, observer=bench)
    begin_s = time.process_time()
    controller.run(dwells(n_windows), n_windows)
    return time.process_time() - begin_s, bench.read


def decode_s(blocks: NDArray[np.int64], n_windows: int) -> float:
    """Return the CPU time of reading and decoding as many windows."""
    bench = FreeBench(blocks)
    geometry = EncoderGeometry(BENCH.counts_per_rev, bench.counter_bits, 1, RATE_HZ)
    state = EncoderState()
    begin_s = time.process_time()
    for _ in range(n_windows):
        state, _motion = decode(state, bench.next_block(), geometry)
    return time.process_time() - begin_s


def measure(n_windows: int, repeats: int) -> tuple[float, float]:
    """Return the CPU time a window of the loop alone, and of decoding, of the least of each."""
    blocks = disc()
    wholes, decodes = [], []
    for _ in range(repeats):
        whole_s, n_read = loop_s(blocks, n_windows)
        wholes.append(whole_s / n_read)
        decodes.append(decode_s(blocks, n_read) / n_read)
    return min(wholes) - min(decodes), min(decodes)


def main(arguments: list[str] | None = None) -> int:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--small", action="store_true", help="a tenth of the windows")
    small = parser.parse_args(arguments).small
    loop, decoding = measure(5_000 if small else 50_000, repeats=3)
    print(f"sweep loop {1e6 * loop:.1f} µs a window (allowed {1e6 * ALLOWED_S:g})")
    print(f"decoding   {1e6 * decoding:.1f} µs a window")
    return int(loop > ALLOWED_S)


if __name__ == "__main__":
    sys.exit(main())
