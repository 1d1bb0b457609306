"""Curves of motors that were driven at few phases: how far off they are between these.

    python benchmarks/identification_few_phases.py [--seed 1] [--motors 20]

Each motor jumps at random among seven, nine or fifteen phases, twice 14 s. Beside the default
method stand splines through the median speed at each phase, the first three windows of each dwell
left aside: the cubic of SciPy's CubicSpline, and the monotone one of its PchipInterpolator. Errors
are root mean squares over all phases between the first and the last, in per cent of the highest
speed.
"""

import argparse
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PchipInterpolator

from benchmarks.plain_motor import PlainMotor, Wrong, motor_of_any_curve, speed_rad_s
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.runs.dwells import dwell_begin
from usmbench.runs.record import Record

Array = NDArray[np.float64]
Curve = Callable[[Array], Array]

PHASES_DEG = (
    np.array([-80.0, -40.0, -20.0, 0.0, 20.0, 40.0, 80.0]),
    np.linspace(-90.0, 90.0, 9),
    np.linspace(-84.0, 84.0, 15),
)
_WINDOW_S, _WINDOWS, _HELD, _SETTLING = 0.01, 1400, 7, 3


def telegraphs(
    motor: PlainMotor,
    phases_deg: Array,
    rng: np.random.Generator,
    names: Sequence[str] = ("one", "two"),
    noise_rad_s: float = 0.02,
) -> list[Record]:
    """Return runs of a motor that jumps among phases."""
    t_s = _WINDOW_S * np.arange(1.0, _WINDOWS + 1.0)
    runs = []
    for name in names:
        phase_deg = np.repeat(rng.choice(phases_deg, _WINDOWS // _HELD), _HELD)
        speed, _ = speed_rad_s(motor, phase_deg, _WINDOW_S, Wrong(), rng)
        noisy = speed + noise_rad_s * rng.standard_normal(_WINDOWS)
        runs.append(Record(name, t_s, phase_deg, noisy, np.full(_WINDOWS, _WINDOW_S)))
    return runs


def identified(runs: Sequence[Record]) -> Curve:
    """Return the default method's curve."""
    return identify_fast(runs, FastOptions()).model.points[0].curve.speed_rad_s


def medians(runs: Sequence[Record]) -> tuple[Array, Array]:
    """Return the phases that were driven, and the median of settled speeds at each."""
    phase_deg = np.concatenate([run.phase_deg for run in runs])
    speed = np.concatenate([run.speed_rad_s for run in runs])
    settled = np.concatenate(
        [np.arange(_WINDOWS) - dwell_begin(run.phase_deg) >= _SETTLING for run in runs]
    )
    driven_deg = np.unique(phase_deg)
    return driven_deg, np.array([np.median(speed[settled & (phase_deg == p)]) for p in driven_deg])


METHODS: dict[str, Callable[[Sequence[Record]], Curve]] = {
    "default": identified,
    "CubicSpline": lambda runs: CubicSpline(*medians(runs)),
    "PchipInterpolator": lambda runs: PchipInterpolator(*medians(runs)),
}


def off_share(seed: int, phases_deg: Array, methods: Sequence[str] = tuple(METHODS)) -> Array:
    """Return how far off each method's curve of a drawn motor is, as shares of its top speed."""
    rng = np.random.default_rng([seed, phases_deg.size])
    motor = motor_of_any_curve(rng)
    runs = telegraphs(motor, phases_deg, rng)
    table_deg = np.linspace(phases_deg[0], phases_deg[-1], 1001)
    true = motor.settled_rad_s(table_deg)
    off = [METHODS[method](runs)(table_deg) - true for method in methods]
    return np.asarray(np.sqrt(np.mean(np.square(off), axis=1)) / np.max(np.abs(true)))


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--motors", type=int, default=20)
    args = parser.parse_args(arguments)
    print("phases   off by, % (median, worst)")
    for phases_deg in PHASES_DEG:
        seeds = range(args.seed * args.motors, (args.seed + 1) * args.motors)
        off = 100.0 * np.array([off_share(seed, phases_deg) for seed in seeds])
        each = zip(METHODS, np.median(off, axis=0), np.max(off, axis=0), strict=True)
        said = "; ".join(f"{name} {middle:.1f}, {worst:.1f}" for name, middle, worst in each)
        print(f"{phases_deg.size:6}   {said}", flush=True)


if __name__ == "__main__":
    main()
