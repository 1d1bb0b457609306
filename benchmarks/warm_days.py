"""Motors that are warm already when a run begins, in CSV files through the commands: what is named.

    python benchmarks/warm_days.py [--seed 1] [--draws 6] [--small]

A motor of a few lines loses speed as it warms, and its dead zone widens. `usmbench identify` sees
files of six runs that began cold; `usmbench diagnose` one that began warm, healthy or with
something wrong, or one that began cold with something wrong, for comparison.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.campaign_tables import share
from benchmarks.naming_from_csv import diagnosed
from benchmarks.plain_motor import (
    FINE,
    PlainMotor,
    Wrong,
    motor_of_any_curve,
    size_of,
    speed_rad_s,
)
from benchmarks.plain_runs import KINDS, noise_rad_s, plan_deg, write_csv

Array = NDArray[np.float64]

GROUPS = ("warm, healthy", "warm, wrong", "cold, wrong")
CAUSES = (
    "thermal_drift",
    "load_torque",
    "speed_scale",
    "phase_offset",
    "gain_asymmetry",
    "encoder_eccentricity",
)
_REFERENCES, _WINDOWS, _WINDOW_S, _TOP_DEG = 6, 6000, 0.01, 88.0
_TIMES_NOISE, _WANDER = 3.0, 0.003


@dataclass(frozen=True, slots=True)
class Warming:
    """How a motor warms.

    Parameters
    ----------
    loses
        Share of the speed that it has lost when it is as warm as it gets.
    widens
        Share by which its dead zone is wider then.
    constant_s
        Thermal time constant.
    """

    loses: float
    widens: float
    constant_s: float

    def of(self, motor: PlainMotor, begins: float, n: int) -> PlainMotor:
        """Return the motor at each step of a run.

        Parameters
        ----------
        motor
            The motor, cold.
        begins
            How warm it is at the start, from 0 to 1.
        n
            Windows of the run.
        """
        t_s = _WINDOW_S / FINE * np.arange(n * FINE)
        warm = 1.0 - (1.0 - begins) * np.exp(-t_s / self.constant_s)
        low_deg, high_deg = motor.edges_deg
        wider = 1.0 + self.widens * warm
        return replace(
            motor,
            top_rad_s=motor.top_rad_s * (1.0 - self.loses * warm),
            edges_deg=(low_deg * wider, high_deg * wider),
        )


@dataclass(frozen=True, slots=True)
class Day:
    """What became of one motor.

    Parameters
    ----------
    group
        One of `GROUPS`.
    cause
        What was wrong; empty for nothing.
    warming
        How the motor warms.
    begins
        How warm it was at the start.
    verdict
        The verdict, or what a command said that ended with an error.
    names
        What was named, each with its alternatives.
    """

    group: str
    cause: str
    warming: Warming
    begins: float
    verdict: str
    names: tuple[tuple[str, ...], ...]

    @property
    def right(self) -> bool:
        """Whether the first name is the cause, or there is none and no finding."""
        if not self.cause:
            return self.verdict == "no_discrepancy"
        return bool(self.names) and self.names[0][0] == self.cause

    @property
    def misled(self) -> bool:
        """Whether the first name is another cause, which its alternatives do not hold."""
        return bool(self.names) and self.cause not in self.names[0]


def draw(seed: int, number: int, n: int = _WINDOWS) -> Day:
    """Draw a motor and its days; identify and diagnose.

    Parameters
    ----------
    seed, number
        What fixes the draw; groups and causes come in turn.
    n
        Windows of a run.
    """
    rng = np.random.default_rng([seed, number])
    group = GROUPS[number % len(GROUPS)]
    cause = "" if group.endswith("healthy") else CAUSES[number // len(GROUPS) % len(CAUSES)]
    motor, deviation_rad_s = motor_of_any_curve(rng), rng.uniform(0.01, 0.03)
    loses = rng.uniform(0.003, 0.03)
    warming = Warming(loses, loses * rng.uniform(0.0, 4.0), float(np.exp(rng.uniform(3.0, 5.0))))
    begins = rng.uniform(0.4, 1.0) if group.startswith("warm") else 0.0
    measured_deg = plan_deg(str(rng.choice(KINDS)), n, _TOP_DEG, rng)
    wrong = _wrong(motor, measured_deg, cause, deviation_rad_s, rng)
    with tempfile.TemporaryDirectory() as name:
        paths = [Path(name) / f"cold{k}.csv" for k in range(_REFERENCES)]
        for path in paths:
            phase_deg = plan_deg(str(rng.choice(KINDS)), n, _TOP_DEG, rng)
            _measure(path, warming.of(motor, 0.0, n), phase_deg, Wrong(), deviation_rad_s, rng)
        path = Path(name) / "measured.csv"
        _measure(path, warming.of(motor, begins, n), measured_deg, wrong, deviation_rad_s, rng)
        names, verdict = diagnosed(Path(name), [str(path) for path in paths])
    return Day(group, cause, warming, begins, verdict, names)


def _wrong(
    motor: PlainMotor,
    phase_deg: Array,
    cause: str,
    deviation_rad_s: float,
    rng: np.random.Generator,
) -> Wrong:
    """Draw what is wrong: so much of a cause that its effect is some times the noise."""
    if not cause:
        return Wrong()

    def speed(wrong: Wrong) -> Array:
        return speed_rad_s(motor, phase_deg, _WINDOW_S, wrong, rng)[0]

    size = size_of(speed, cause, _TIMES_NOISE * deviation_rad_s)
    if size is None:
        raise ValueError(f"no size of {cause} does {_TIMES_NOISE:g} times the noise")
    sign = -1.0 if cause in ("speed_scale", "gain_asymmetry") and rng.integers(2) else 1.0
    return Wrong(cause, sign * size)


def _measure(
    path: Path,
    motor: PlainMotor,
    phase_deg: Array,
    wrong: Wrong,
    deviation_rad_s: float,
    rng: np.random.Generator,
) -> None:
    today = replace(motor, top_rad_s=motor.top_rad_s * (1.0 + _WANDER * rng.standard_normal()))
    speed, angle_rad = speed_rad_s(today, phase_deg, _WINDOW_S, wrong, rng)
    noisy = speed + noise_rad_s(phase_deg.size, deviation_rad_s, 0.0, rng)
    write_csv(path, phase_deg, noisy, angle_rad, _WINDOW_S)


def report(days: Sequence[Day]) -> None:
    """Print how many are right, how many are misled, and which are not right.

    Parameters
    ----------
    days
        Of the draws.
    """
    print(f"{'':16}right                   another name first")
    for group in GROUPS:
        rows = [day for day in days if day.group == group]
        if rows:
            right, misled = sum(day.right for day in rows), sum(day.misled for day in rows)
            mean, low, high = share(right, len(rows))
            print(
                f"{group:16}{100 * mean:5.1f} ({100 * low:3.0f}-{100 * high:3.0f} %) of {len(rows)}"
                f"   {misled}"
            )
    for day in days:
        if not day.right:
            names = "; ".join(", ".join(names) for names in day.names)
            print(
                f"{day.group} {day.cause}: {day.verdict} {names} (began at {day.begins:.2f}, "
                f"loses {100 * day.warming.loses:.1f} %, widens {100 * day.warming.widens:.1f} %, "
                f"{day.warming.constant_s:.0f} s)"
            )


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=6, help="of each group")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--small", action="store_true", help="one of each group")
    arguments = parser.parse_args(argv)
    n = len(GROUPS) * (1 if arguments.small else arguments.draws)
    with get_context("spawn").Pool(arguments.processes) as pool:
        report(pool.starmap(draw, [(arguments.seed, k) for k in range(n)], chunksize=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
