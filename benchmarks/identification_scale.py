"""Time and memory of a fit up to ten million rows, beside BLAS on the same regressors.

    python benchmarks/identification_scale.py [--small]

Each size runs in a process of its own: a random-phase record of a known Hammerstein motor, five
windows a dwell, degree 18. "W" is the regressor matrix of the paper's eq. (18) for the dynamics
that are fitted (one past speed, 19 functions at three lags: 58 columns), "J" that of the free run's
sensitivities (21 columns). BLAS's time is that of WᵀW and JᵀJ alone, block by block in the cache,
without the time to form W or J. One BLAS thread, CPU time.
"""

import argparse
import os
import resource
import subprocess
import sys
import time

import numpy as np
from numpy.typing import NDArray

from benchmarks.identification_coverage import CURVE, NOISE_RAD_S, WINDOW_S, true_dynamics
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Array = NDArray[np.float64]

COLUMNS_W, COLUMNS_J = 58, 21
DEGREE = 18
_BLOCK = 8192
_PIECE, _MEMORY = 500_000, 100


def gram_s(n: int, columns: int) -> float:
    """Return BLAS's CPU time for the Gram matrix of n rows."""
    block = np.random.default_rng(0).standard_normal((_BLOCK, columns))
    rounds = max(1, min(n, 2_000_000) // _BLOCK)
    gram = block.T @ block
    begun_s = time.process_time()
    for _ in range(rounds):
        gram += block.T @ block
    return (time.process_time() - begun_s) * n / (rounds * _BLOCK)


def long_record(n: int) -> Record:
    """Return a run of the known motor, made in pieces: making it must not be what takes memory."""
    rng = np.random.default_rng(1)
    phase_deg = np.repeat(rng.uniform(-90.0, 90.0, n // 5 + 1), 5)[:n].copy()
    speed_rad_s = np.empty(n)
    for first in range(0, n, _PIECE):
        before = min(first, _MEMORY)
        settled_rad_s = CURVE.speed_rad_s(phase_deg[first - before : first + _PIECE])
        clean = free_run(true_dynamics(), settled_rad_s)[before:]
        speed_rad_s[first : first + _PIECE] = clean + NOISE_RAD_S * rng.standard_normal(clean.size)
    t_s: Array = np.arange(1.0, n + 1.0)
    t_s *= WINDOW_S
    return Record("long", t_s, phase_deg, speed_rad_s, np.broadcast_to(WINDOW_S, n))


def one_size(n: int) -> None:
    """Fit once and print: rows, fit and its peak memory in megabytes."""
    run = long_record(n)
    begun_s = time.process_time()
    identify_fast([run], FastOptions(degree=DEGREE))
    fit_s = time.process_time() - begun_s
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"{n} {fit_s} {peak_mb}")


def measured(n: int) -> tuple[float, float]:
    """Return CPU time and peak memory of a fit in a process of its own."""
    done = subprocess.run(
        [sys.executable, __file__, "--one", str(n)],
        check=True,
        capture_output=True,
        text=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    _, fit_s, peak_mb = (float(word) for word in done.stdout.split())
    return fit_s, peak_mb


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="up to 30 000 rows")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.one is not None:
        one_size(args.one)
        return
    sizes = (10_000, 30_000) if args.small else (10_000, 100_000, 1_000_000, 10_000_000)
    print(f"{'rows':>9} {'fit':>9} {'peak':>8} {'WᵀW':>9} {'fit/WᵀW':>8} {'JᵀJ':>9} {'fit/JᵀJ':>8}")
    for n in sizes:
        fit_s, peak_mb = measured(n)
        w_s, j_s = gram_s(n, COLUMNS_W), gram_s(n, COLUMNS_J)
        print(
            f"{n:9d} {fit_s:7.2f} s {peak_mb:5.0f} MB {w_s:7.3f} s {fit_s / w_s:8.1f} "
            f"{j_s:7.3f} s {fit_s / j_s:8.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
