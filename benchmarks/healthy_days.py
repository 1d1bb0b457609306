"""Healthy motors on other days, in CSV files through the commands: what gets a name.

    python benchmarks/healthy_days.py [--seed 1] [--draws 12] [--braking] [--small]

A motor of a few lines starts steeply, at a corner or gently, with ends of the dead zone that are
not alike. Gain and dead zone are another each day, each by a share of itself. `usmbench identify`
sees files of six days, `usmbench diagnose` that of a seventh, driven by another plan; a rotor that
stands has no noise. With --braking, motors brake in 40 to 80 % of the time that they take to run
up, and the six days are all of one plan, of which the seventh is not.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.campaign_tables import share
from benchmarks.naming_from_csv import diagnosed
from benchmarks.plain_motor import CURVES, PlainMotor, Wrong, motor_of, speed_rad_s
from benchmarks.plain_runs import KINDS, noise_rad_s, plan_deg, write_csv

Array = NDArray[np.float64]

WANDERS = (0.0, 0.003, 0.01)
_DAYS, _WINDOWS, _WINDOW_S, _TOP_DEG = 6, 3000, 0.01, 88.0
_FULL_NOISE_RAD_S = 0.2  # speed from which on a rotor has all of its noise


@dataclass(frozen=True, slots=True)
class Healthy:
    """What became of one motor.

    Parameters
    ----------
    wander
        Relative wander of gain and dead zone from day to day.
    curve
        How it starts and saturates.
    verdict
        The verdict on a day of its own, or what a command said that ended with an error.
    names
        What was named.
    """

    wander: float
    curve: str
    verdict: str
    names: tuple[str, ...]


def on_a_day(motor: PlainMotor, wander: float, rng: np.random.Generator) -> PlainMotor:
    """Return a motor as it is on one day.

    Parameters
    ----------
    motor
        The motor.
    wander
        Relative wander of gain and dead zone.
    rng
        Where chance comes from.
    """
    gain, width = 1.0 + wander * rng.standard_normal(2)
    low_deg, high_deg = motor.edges_deg
    return replace(
        motor, top_rad_s=gain * motor.top_rad_s, edges_deg=(width * low_deg, width * high_deg)
    )


def draw(seed: int, number: int, n: int = _WINDOWS, *, braking: bool = False) -> Healthy:
    """Draw a motor and its days; identify and diagnose.

    Parameters
    ----------
    seed, number
        What fixes the draw; wanders and curves come in turn.
    n
        Windows of a run.
    braking
        Whether the motor brakes faster than it runs up, and its days are of one plan.
    """
    rng = np.random.default_rng([seed, number])
    curve = list(CURVES)[number % len(CURVES)]
    wander = WANDERS[number // len(CURVES) % len(WANDERS)]
    low_deg, high_deg = rng.uniform(4.0, 15.0, 2)
    motor = replace(motor_of(rng), curve=curve, edges_deg=(low_deg, high_deg))
    deviation_rad_s, colour = rng.uniform(0.008, 0.03), rng.choice([0.0, 0.6])
    plans: list[str] = []
    if braking:
        motor = replace(motor, brakes_in=float(rng.uniform(0.4, 0.8)))
        usual, other = (str(kind) for kind in rng.choice(KINDS, 2, replace=False))
        plans = [*[usual] * _DAYS, other]
    with tempfile.TemporaryDirectory() as name:
        paths = [Path(name) / f"day{k}.csv" for k in range(_DAYS)]
        for k, path in enumerate([*paths, Path(name) / "measured.csv"]):
            kind = plans[k] if plans else str(rng.choice(KINDS))
            phase_deg = plan_deg(kind, n, _TOP_DEG, rng)
            day = on_a_day(motor, wander, rng)
            speed, angle_rad = speed_rad_s(day, phase_deg, _WINDOW_S, Wrong(), rng)
            noise = noise_rad_s(n, deviation_rad_s, colour, rng)
            noisy = speed + noise * np.minimum(np.abs(speed) / _FULL_NOISE_RAD_S, 1.0)
            write_csv(path, phase_deg, noisy, angle_rad, _WINDOW_S)
        names, verdict = diagnosed(Path(name), [str(path) for path in paths])
    return Healthy(wander, curve, verdict, tuple(first for first, *_ in names))


def report(found: Sequence[Healthy]) -> None:
    """Print how many are said to be healthy, and what the others got.

    Parameters
    ----------
    found
        Of the draws.
    """
    print("healthy, said so")
    groups = [(f"wander {100 * w:g} %", [h for h in found if h.wander == w]) for w in WANDERS]
    groups += [(curve, [h for h in found if h.curve == curve]) for curve in CURVES]
    for name, rows in [*groups, ("all", list(found))]:
        if rows:
            right = sum(h.verdict == "no_discrepancy" for h in rows)
            mean, low, high = share(right, len(rows))
            print(
                f"{name:16} {100 * mean:5.1f} ({100 * low:3.0f}-{100 * high:3.0f} %) of {len(rows)}"
            )
    for h in found:
        if h.verdict != "no_discrepancy":
            print(f"{h.curve}, {100 * h.wander:g} %: {h.verdict} {', '.join(h.names)}")


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=12, help="of each wander")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--braking", action="store_true", help="motors that brake faster")
    parser.add_argument("--small", action="store_true", help="two motors")
    arguments = parser.parse_args(argv)
    n = 2 if arguments.small else len(WANDERS) * arguments.draws
    with get_context("spawn").Pool(arguments.processes) as pool:
        drawn = partial(draw, braking=arguments.braking)
        report(pool.starmap(drawn, [(arguments.seed, k) for k in range(n)], chunksize=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
