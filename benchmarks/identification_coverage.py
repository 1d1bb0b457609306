"""Coverage of the 95 % intervals over simulated data sets with white and with coloured noise.

    python benchmarks/identification_coverage.py [--small]

Each data set is a random-phase run of 3000 windows of a known Hammerstein motor (lag 3.5 ms, dead
time 1.5 ms, Bézier curve with a dead zone) with its own noise. Printed are the share of sets whose
interval holds the true value, and how often each test of the residual, at 5 %, rejects though
nothing is left.
"""

import argparse
from collections import defaultdict

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.knots import dead_zone_deg
from usmbench.identify.lag_family import LagFamily
from usmbench.model.hammerstein import LinearPart, StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Array = NDArray[np.float64]

WINDOW_S, TAU_S, DEAD_TIME_S = 0.01, 0.0035, 0.0015
KNOTS_DEG = np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90])
DELTA_RAD_S = np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4])
CURVE = StaticCurve(KNOTS_DEG, DELTA_RAD_S)
NOISE_RAD_S = 0.05


def true_dynamics() -> LinearPart:
    """Return the known motor's dynamics."""
    parameters = np.array([np.log(TAU_S / WINDOW_S), DEAD_TIME_S / WINDOW_S])
    return LagFamily(1.0).dynamics(parameters).linear_part(WINDOW_S)


def record(seed: int, n: int, colour: float) -> Record:
    """Return a run of the known motor with autoregressive noise of a given coefficient."""
    rng = np.random.default_rng(seed)
    phase_deg = np.repeat(rng.uniform(-90.0, 90.0, n // 5 + 1), 5)[:n]
    clean = free_run(true_dynamics(), CURVE.speed_rad_s(phase_deg))
    white = NOISE_RAD_S * np.sqrt(1.0 - colour**2) * rng.standard_normal(n + 100)
    noise: Array = lfilter([1.0], [1.0, -colour], white)[100:]
    t_s: Array = WINDOW_S * np.arange(1.0, n + 1.0)
    speed_rad_s: Array = clean + noise
    return Record(f"set {seed}", t_s, phase_deg, speed_rad_s, np.full(n, WINDOW_S))


def coverage(n_sets: int, colour: float, n: int = 3000) -> dict[str, float]:
    """Return the share of sets whose interval holds the truth, by quantity.

    Parameters
    ----------
    n_sets
        Number of data sets.
    colour
        Autoregressive coefficient of the noise.
    n
        Windows in each.
    """
    true_linear = true_dynamics()
    low_deg, high_deg = dead_zone_deg(CURVE)
    hits: dict[str, list[float]] = defaultdict(list)
    for seed in range(n_sets):
        options = FastOptions(knots_deg=tuple(KNOTS_DEG.tolist()))
        found = identify_fast([record(seed, n, colour)], options)
        model = found.model
        for test in found.tests:
            hits[f"false alarm: {test.question}"].append(float(test.p_value < 0.05))
        shared, own = model.intervals, model.intervals["points"][0]
        hits["a_1"].append(_holds(shared["a"][0], float(true_linear.a[0])))
        hits["b_0"].append(_holds(shared["b"][0], float(true_linear.b[0])))
        hits["b_1"].append(_holds(shared["b"][1], float(true_linear.b[1])))
        hits["tau_s"].append(_holds(shared["tau_s"], TAU_S))
        hits["dead_time_s"].append(_holds(shared["dead_time_s"], DEAD_TIME_S))
        hits["dead zone, low"].append(_holds(own["dead_zone_low_deg"], low_deg))
        hits["dead zone, high"].append(_holds(own["dead_zone_high_deg"], high_deg))
        band = own["band"]
        true_rad_s = CURVE.speed_rad_s(np.clip(np.array(band["phase_deg"]), -90.0, 90.0))
        inside = (np.array(band["low_rad_s"]) <= true_rad_s) & (
            true_rad_s <= np.array(band["high_rad_s"])
        )
        hits["band, average over the phases"].append(float(inside.mean()))
        gain = float(np.max(np.abs(true_rad_s)))
        hits["gain"].append(_holds(own["gain_rad_s"], gain))
    return {name: float(np.mean(values)) for name, values in hits.items()}


def _holds(interval: list[float] | None, truth: float | None) -> float:
    if interval is None or truth is None:
        return 0.0
    return float(interval[0] <= truth <= interval[1])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="40 sets instead of 1000")
    args = parser.parse_args()
    n_sets = 40 if args.small else 1000
    white, coloured = coverage(n_sets, 0.0), coverage(n_sets, 0.6)
    print(f"{n_sets} data sets: share whose 95 % interval holds the truth; false alarms at 5 %")
    print(f"{'':48} {'white noise':>12} {'AR(1), 0.6':>12}")
    for name in white:
        print(f"{name:48} {100 * white[name]:11.1f} % {100 * coloured[name]:11.1f} %")


if __name__ == "__main__":
    main()
