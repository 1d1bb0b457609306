"""The size from which on a cause is named, beside that of a test told the cause's form.

    python benchmarks/naming_power.py [--repeats 6] [--motor 3] [--small]

The likelihood-ratio test knows what the mechanism does to the speed at every window (from pairs of
runs with and without it, the noise the same) and only has to find its size, with the model's
uncertainty and the noise that diagnose works with. It reaches 90 % power at 5 % false alarms where
the whitened effect has a length of 1.96 + 1.28. Diagnose is then shown runs with the mechanism at
multiples of that size.
"""

import argparse
import math
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.optimize import isotonic_regression

from benchmarks.campaign_bench import SMALL_REFERENCE_S, MotorBench, references
from benchmarks.campaign_runs import Excited, Motor
from benchmarks.campaign_tables import share
from benchmarks.told_test import LENGTH, told_length
from hil_sim.defects import CATALOGUE
from usmbench.diagnose.naming.found import Found
from usmbench.runs.reader import read_run

MECHANISMS = (
    "amplifier_delay",
    "leaning_teeth",
    "worn_contact",
    "dragging_bearing",
    "eccentric_disc",
    "command_queue",
    "flywheel",
    "lossy_ceramic",
)
MULTIPLES = (1.0, 1.25, 1.5, 2.0, 3.0)
_GOAL = 1.5
_SHARE, _ROUNDING = 0.9, 1e-9
_LARGE, _ROUNDS = 10.0, 4


@dataclass(frozen=True, slots=True)
class Hits:
    """Runs in which a cause came out.

    Parameters
    ----------
    first
        As the first name.
    in_set
        As the first name, or as a stated alternative to it.
    """

    first: int
    in_set: int


class Power:
    """One motor, one plan.

    Parameters
    ----------
    bench
        The motor.
    excited
        How it is driven.
    """

    def __init__(self, bench: MotorBench, excited: Excited):
        self._bench, self._excited = bench, excited
        self._record = read_run(bench.measured(excited, 0))

    @cached_property
    def _found(self) -> Found:
        return self._bench.searched(self._record)

    def told_size(self, mechanism: str) -> float:
        """Return the size at which the test that is told the form has a power of 90 %."""
        # From an effect some times as large, so that three days show its size well enough. Not all
        # grow with their size alike.
        size = CATALOGUE[mechanism].typical
        for _ in range(_ROUNDS):
            large = (CATALOGUE[mechanism](_LARGE * size),)
            effects_rad_s = self._bench.effects.effects_rad_s(self._excited, large)
            size *= _LARGE * LENGTH / told_length(effects_rad_s, self._record, self._found)
        return size

    def named(self, mechanism: str, size: float, repeats: int) -> Hits:
        """Return in how many runs the cause of the mechanism comes out."""
        defect, first, in_set = CATALOGUE[mechanism](size), 0, 0
        for k in range(repeats):
            run = self._bench.measured(self._excited, 100 + k, (defect,))
            for cause in self._bench.diagnosis(run)["causes"][:1]:
                first += cause["name"] == defect.cause
                in_set += defect.cause in (cause["name"], *cause["alternatives"])
        return Hits(first, in_set)


def size_of_90_percent(multiples: Sequence[float], hits: Sequence[int], n: int) -> float:
    """Return the multiple from which on a share of 90 % is named, infinite for none.

    Between the sizes tried the share is straight in the logarithm of the size, and falls nowhere
    (isotonic regression): no law says how it rises, and a single miss of large sizes is no reason
    to take it for less steep.

    Parameters
    ----------
    multiples
        Sizes, rising.
    hits
        Named runs at each.
    n
        Runs at each.
    """
    shares = isotonic_regression(np.array(hits) / n).x
    reached = np.flatnonzero(shares >= _SHARE - _ROUNDING)
    if not reached.size:
        return math.inf
    first = int(reached[0])
    if first == 0:
        return multiples[0]
    between = slice(first - 1, first + 1)
    return float(np.exp(np.interp(_SHARE, shares[between], np.log(multiples[between]))))


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--motor", type=int, default=3)
    parser.add_argument("--repeats", type=int, default=6)
    parser.add_argument("--plan", default="telegraph")
    parser.add_argument("--duration", type=float, default=20.0, help="of each run, in seconds")
    parser.add_argument("--mechanisms", nargs="+", choices=list(CATALOGUE), default=MECHANISMS)
    parser.add_argument("--small", action="store_true", help="one mechanism, one run a size")
    arguments = parser.parse_args(argv)
    mechanisms, repeats, motor = arguments.mechanisms, arguments.repeats, Motor(arguments.motor)
    excited = Excited(arguments.plan, arguments.duration, 77)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if arguments.small:
            mechanisms, repeats = mechanisms[:1], 1
            bench = MotorBench(folder, folder, motor, references(SMALL_REFERENCE_S))
        else:
            bench = MotorBench(folder, folder, motor, references())
        hits = _table(Power(bench, excited), mechanisms, repeats)
    n = repeats * len(mechanisms)
    by_multiple = list(zip(*hits, strict=True))
    _total("first", [sum(h.first for h in at) for at in by_multiple], n)
    _total("in the set", [sum(h.in_set for h in at) for at in by_multiple], n)
    return 0


def _total(kind: str, hits: Sequence[int], n: int) -> None:
    """Print the shares over all mechanisms."""
    print()
    for multiple, k in zip(MULTIPLES, hits, strict=True):
        mean, low, high = share(k, n)
        print(
            f"at {multiple:3g} x: {kind} in {100 * mean:5.1f} % "
            f"({100 * low:.1f} to {100 * high:.1f} %) of {n}"
        )
    print(
        f"90 % {kind} at {size_of_90_percent(MULTIPLES, hits, n):.2f} x the size of the test that "
        f"is told the form (goal {_GOAL})"
    )


def _table(power: Power, mechanisms: Sequence[str], repeats: int) -> list[list[Hits]]:
    """Print a line a mechanism; return its runs at each multiple."""
    table = []
    header = " ".join(f"{multiple:>9g} x" for multiple in MULTIPLES)
    print("named first / first or an alternative, in per cent of the runs; 90 % of them from")
    print(f"{'mechanism':20} {'told, from':>12} {'unit':6} {header}")
    for mechanism in mechanisms:
        size = power.told_size(mechanism)
        hits = [power.named(mechanism, multiple * size, repeats) for multiple in MULTIPLES]
        table.append(hits)
        per_cent = 100.0 / repeats
        shown = " ".join(f"{per_cent * h.first:5.0f}/{per_cent * h.in_set:5.0f}" for h in hits)
        at = (
            size_of_90_percent(MULTIPLES, counts, repeats)
            for counts in ([h.first for h in hits], [h.in_set for h in hits])
        )
        ninety = " / ".join(f"{multiple:.2f}" for multiple in at)
        unit = CATALOGUE[mechanism].unit
        print(f"{mechanism:20} {size:12.3g} {unit:6} {shown}   {ninety} x", flush=True)
    return table


if __name__ == "__main__":
    sys.exit(main())
