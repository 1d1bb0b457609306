"""Round trip of set_phase to the emulated board in real time, against what the bytes take.

Driver, pseudo-terminal and `python -m hil_sim` as in use. Run as
``python benchmarks/command_round_trip.py``; exits 1 where the median is more than 1.3 times the
time that request and reply take on the line. ``--small`` takes seconds.
"""

import argparse
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol._generated import (
    BAUD,
    BITS_PER_BYTE,
    REPLY_LAYOUTS,
    REQUEST_LAYOUTS,
    RequestType,
)
from usmbench.instruments.protocol.frames import encoded_size
from usmbench.settings.bench import GeneratorSettings

ALLOWED_RATIO = 1.3
SIZES = {"B": 1, "h": 2, "H": 2, "I": 4}


def wire_minimum_s() -> float:
    """Time that a set_phase request and its acknowledgement take on the line."""
    layouts = (REQUEST_LAYOUTS[RequestType.SET_PHASE], REPLY_LAYOUTS[RequestType.SET_PHASE])
    n_bytes = sum(encoded_size(sum(SIZES[code] for _, code in layout)) for layout in layouts)
    return n_bytes * BITS_PER_BYTE / BAUD


@contextmanager
def simulated_port() -> Iterator[str]:
    """Run the simulated testbed in real time and give its serial port."""
    process = subprocess.Popen(
        [sys.executable, "-m", "hil_sim", "--json", "--stdin-control"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        yield str(json.loads(process.stdout.readline())["port"])
    finally:
        process.stdin.close()
        process.terminate()
        process.wait(10.0)
        process.stdout.close()


def measure(generator: SignalGenerator, n_commands: int) -> list[float]:
    """Time that many set_phase commands, each to another phase."""
    times_s = []
    for k in range(n_commands):
        start_s = time.perf_counter()
        generator.phase_deg = k % 180
        times_s.append(time.perf_counter() - start_s)
    return times_s


def main(arguments: list[str] | None = None) -> int:
    """Print median, 95th percentile and the ratio to the wire's minimum."""
    parser = argparse.ArgumentParser(description="Round trip of a command in real time.")
    parser.add_argument("--small", action="store_true", help="300 commands instead of 5000")
    options = parser.parse_args(arguments)
    with (
        simulated_port() as port,
        SignalGenerator.open(GeneratorSettings(port=port)) as generator,
    ):
        generator.set_drive(41_000.0, 0.0)
        times_s = measure(generator, 300 if options.small else 5000)
    minimum_s = wire_minimum_s()
    median_s = statistics.median(times_s)
    p95_s = statistics.quantiles(times_s, n=20)[-1]
    ratio = median_s / minimum_s
    print(
        f"set_phase round trip: median {median_s * 1e3:.3f} ms, 95 % {p95_s * 1e3:.3f} ms; "
        f"on the line {minimum_s * 1e3:.3f} ms; median ratio {ratio:.2f} (at most {ALLOWED_RATIO})"
    )
    return 0 if ratio <= ALLOWED_RATIO else 1


if __name__ == "__main__":
    sys.exit(main())
