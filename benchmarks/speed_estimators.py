"""Error of speed estimators on the same counter samples, at constant and at changing speed.

    python benchmarks/speed_estimators.py [--small]

100 kS/s, 1000 samples a window, 2000 counts a revolution. Beside `average` (the paper's) and
`edge_timed` (ours): `reciprocal`, the last edge of the window before to the last edge of this one,
and `slope`, the least-squares line through the counts at this window's edges. The transients are
exponential, 3.5 ms, between 0.2 and 1 times the speed in the first column, every 50 ms.
"""

import argparse
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from usmbench.instruments.encoder import EncoderGeometry, EncoderState, decode
from usmbench.instruments.samples import SampleBlock

RATE_HZ = 100_000.0
SAMPLES = 1000
WINDOW_S = SAMPLES / RATE_HZ
GEOMETRY = EncoderGeometry(2000, 32, 1, RATE_HZ)
COUNT_RAD = GEOMETRY.rad_per_count
LAG_S = 3.5e-3
SPEEDS_RAD_S = (0.3, 1.0, 1.5, 2.0, 3.0, 5.0, 7.5, 10.25)

Angle = NDArray[np.float64]


def constant(speed_rad_s: float, n_windows: int, rng: np.random.Generator) -> Angle:
    """Return the exact angle at every sample, at one speed from a random start."""
    return rng.uniform(0, COUNT_RAD) + np.arange(n_windows * SAMPLES) / RATE_HZ * speed_rad_s


def transients(speed_rad_s: float, n_windows: int, rng: np.random.Generator) -> Angle:
    """Return the exact angle at every sample while the speed goes up and down."""
    t_s = np.arange(n_windows * SAMPLES) / RATE_HZ + rng.uniform(0, WINDOW_S)
    step = 0.8 * speed_rad_s
    rising = np.floor(t_s / 0.05) % 2 == 0
    target = np.where(rising, speed_rad_s, 0.2 * speed_rad_s)
    speed = target + np.where(rising, -step, step) * np.exp(-(t_s % 0.05) / LAG_S)
    return rng.uniform(0, COUNT_RAD) + np.cumsum(speed) / RATE_HZ


def ours(position: NDArray[np.int64]) -> tuple[Angle, Angle, float]:
    """Return `average`, `edge_timed` and the CPU time of a window."""
    state, average, edge_timed = EncoderState(), [], []
    started = time.process_time()
    for first in range(0, len(position), SAMPLES):
        block = SampleBlock(first, position[first : first + SAMPLES])
        state, motion = decode(state, block, GEOMETRY)
        average.append(motion.average_rad_s)
        edge_timed.append(motion.edge_timed_rad_s)
    cost_s = (time.process_time() - started) / len(average)
    return np.array(average), np.array(edge_timed), cost_s


def peers(position: NDArray[np.int64]) -> tuple[Angle, Angle]:
    """Return `reciprocal` and `slope`; a window without enough edges keeps the speed before."""
    at = np.flatnonzero(np.diff(position)) + 1
    edge_s, edge_rad = (at - 0.5) / RATE_HZ, position[at] * COUNT_RAD
    ends = np.searchsorted(at, np.arange(SAMPLES, len(position) + 1, SAMPLES))
    reciprocal, slope = np.zeros(len(ends)), np.zeros(len(ends))
    for k in range(1, len(ends)):
        first, last = max(ends[k - 1] - 1, 0), ends[k] - 1
        reciprocal[k], slope[k] = reciprocal[k - 1], slope[k - 1]
        if last > first:
            reciprocal[k] = (edge_rad[last] - edge_rad[first]) / (edge_s[last] - edge_s[first])
        if last > first + 1:
            t_s = edge_s[first + 1 : last + 1] - edge_s[first + 1 : last + 1].mean()
            slope[k] = (t_s @ edge_rad[first + 1 : last + 1]) / (t_s @ t_s)
    return reciprocal, slope


def errors_percent(speed_rad_s: float, angle: Angle) -> tuple[dict[str, float], float]:
    """Return each estimator's rms error in percent of the speed, and our CPU time a window.

    Parameters
    ----------
    speed_rad_s
        Speed that the errors are divided by.
    angle
        Exact angle at every sample.
    """
    exact = np.diff(angle[SAMPLES - 1 :: SAMPLES]) / WINDOW_S
    position = np.floor(angle / COUNT_RAD).astype(np.int64)
    average, edge_timed, cost_s = ours(position)
    reciprocal, slope = peers(position)
    found = {
        "average": average,
        "edge_timed": edge_timed,
        "reciprocal": reciprocal,
        "slope": slope,
    }
    # The first windows have no past to lean on.
    return {
        name: 100.0 * float(np.sqrt(np.mean((value[1:] - exact)[2:] ** 2))) / speed_rad_s
        for name, value in found.items()
    }, cost_s


def any_speed(n_speeds: int, n_windows: int, rng: np.random.Generator) -> tuple[float, float]:
    """Return edge_timed's worst and rms error in percent over random constant speeds.

    The worst are speeds whose edges come almost a whole number of samples apart: all stamps are
    then off the same way, and longer fits do not average that out.

    Parameters
    ----------
    n_speeds
        Number of speeds, uniform between 1 and 16 rad/s.
    n_windows
        Windows at each.
    rng
        Source of the speeds.
    """
    errors = np.array(
        [
            errors_percent(speed, constant(speed, n_windows, rng))[0]["edge_timed"]
            for speed in rng.uniform(1.0, 16.0, n_speeds).tolist()
        ]
    )
    return float(errors.max()), float(np.sqrt(np.mean(errors**2)))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--small", action="store_true", help="a tenth of the windows")
    n_windows = 200 if parser.parse_args().small else 2000
    rng = np.random.default_rng()
    motions: tuple[tuple[str, Callable[[float, int, np.random.Generator], Angle]], ...] = (
        ("constant speed", constant),
        ("3.5 ms transients", transients),
    )
    costs_s = []
    for title, motion in motions:
        print(f"{title}: rms error in % of the speed, {n_windows} windows each")
        print("  rad/s    average  edge_timed  reciprocal     slope")
        for speed_rad_s in SPEEDS_RAD_S:
            error, cost_s = errors_percent(speed_rad_s, motion(speed_rad_s, n_windows, rng))
            costs_s.append(cost_s)
            print(
                f"{speed_rad_s:7.2f} {error['average']:10.4f} {error['edge_timed']:11.4f} "
                f"{error['reciprocal']:11.4f} {error['slope']:9.4f}"
            )
    worst, rms = any_speed(n_windows // 10, n_windows // 10, rng)
    print(
        f"edge_timed at random constant speeds from 1 to 16 rad/s: {rms:.4f} %, worst {worst:.4f} %"
    )
    print(f"decode: {1e6 * float(np.median(costs_s)):.0f} µs of CPU a window (median)")


if __name__ == "__main__":
    main()
