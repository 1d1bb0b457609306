"""The paper's search on 40 settled pairs of the simulated motor, from a hundred random starts.

    python benchmarks/identification_paper.py [--small]

The pairs are taken at 41 kHz from −90° to 90° and scaled to a highest speed of 1; degree and knots
are those of the paper's Section V. For each α are printed how many starts come to the paper's sum
of squares, in how many iterations, and where they come to rest when nothing stops them but
standstill.
"""

import argparse
from dataclasses import dataclass

import numpy as np

from benchmarks.testbed_runs import head, measured, points, scaled
from usmbench.identify.paper import PaperOptions, identify_paper
from usmbench.identify.paper_lm import LmOptions, LmResult
from usmbench.runs.record import Record

PAPER_SSE = 5.35e-5
ALPHAS = (1.01, 1.1, 2.0)
N_POINTS = 40


@dataclass(frozen=True, slots=True)
class Starts:
    """What became of the random starts.

    Parameters
    ----------
    reached
        How many came to the paper's sum of squares.
    iterations
        Iterations of each until there.
    rest_sse, rest_iterations
        Sum of squares at which each comes to rest, and iterations until there.
    """

    reached: int
    iterations: list[int]
    rest_sse: list[float]
    rest_iterations: list[int]


def forty_points(warm_up_s: int) -> Record:
    """Return 40 settled pairs of the simulated motor, scaled to 1."""
    phases_deg = np.linspace(-90.0, 90.0, N_POINTS)
    return scaled(measured([head(warm_up_s=warm_up_s) + points(phases_deg)], 1)[0])


def from_random_starts(record: Record, alpha: float, seeds: int) -> Starts:
    """Search from several starts with one α."""

    def search(seed: int, options: LmOptions) -> LmResult:
        return identify_paper([record], PaperOptions(seed=seed, search=options)).result

    until_paper = LmOptions(alpha=alpha, target_sse=PAPER_SSE)
    until_rest = LmOptions(alpha=alpha, stall_relative=1e-6)
    there = [search(seed, until_paper) for seed in range(seeds)]
    rest = [search(seed, until_rest) for seed in range(seeds)]
    good = [result for result in there if result.sse <= PAPER_SSE]
    return Starts(
        len(good),
        [len(result.trace) for result in good],
        [result.sse for result in rest],
        [len(result.trace) for result in rest],
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="5 starts and a short warm-up")
    args = parser.parse_args()
    seeds, warm_up_s = (5, 5) if args.small else (100, 300)
    record = forty_points(warm_up_s)
    print(f"{seeds} random starts, {N_POINTS} points, degree 18; the paper's SSE is {PAPER_SSE:g}")
    print(
        f"{'alpha':>6} {'reach it':>9} {'iterations there':>24} {'SSE at rest':>26} {'until':>12}"
    )
    for alpha in ALPHAS:
        found = from_random_starts(record, alpha, seeds)
        there = found.iterations or [0]
        print(
            f"{alpha:6g} {found.reached:5d}/{seeds:<3d} "
            f"{f'{np.median(there):.0f} ({min(there)} to {max(there)})':>24} "
            f"{f'{min(found.rest_sse):.3g} to {max(found.rest_sse):.3g}':>26} "
            f"{np.median(found.rest_iterations):12.0f}"
        )


if __name__ == "__main__":
    main()
