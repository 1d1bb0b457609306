"""The exact inverse map beside the paper's iteration.

    python benchmarks/inverse_map.py [--small]

A million random phases over the paper's 19 knots. The paper's error feedback, with γ = 0.01 and
started at random, is run on a thousand of them until 1e-11° are left, which is about what its
steps of γ times the error can resolve in doubles.
"""

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from usmbench.identify.paper import KNOTS_BOTH_WAYS_DEG
from usmbench.identify.paper_inverse_map import inverse_de_casteljau
from usmbench.model.inverse_map import bezier_abscissa


def timed(call: Callable[[], Any]) -> tuple[Any, float]:
    """Return a call's result and the CPU time it took."""
    begun_s = time.process_time()
    result = call()
    return result, time.process_time() - begun_s


def compare(n: int, n_paper: int) -> dict[str, float]:
    """Return times and the largest difference."""
    knots_deg = np.array(KNOTS_BOTH_WAYS_DEG)
    rng = np.random.default_rng(0)
    phase_deg = rng.uniform(-90.0, 90.0, n)
    x, own_s = timed(lambda: bezier_abscissa(phase_deg, knots_deg))
    some_deg = phase_deg[:n_paper]
    (x_paper, rounds), paper_s = timed(
        lambda: inverse_de_casteljau(some_deg, knots_deg, rng, tolerance_deg=1e-11)
    )
    return {
        "ours, s": own_s,
        "paper, s": paper_s * n / n_paper,
        "rounds": rounds,
        "largest difference": float(np.max(np.abs(x[:n_paper] - x_paper))),
    }


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="a hundredth of the phases")
    args = parser.parse_args()
    n = 10_000 if args.small else 1_000_000
    found = compare(n, 1000)
    ours_s, paper_s = found["ours, s"], found["paper, s"]
    print(f"{n} phases: {ours_s:.3f} s of CPU; the paper's iteration {paper_s:.0f} s")
    print(f"(from 1000 of them, {found['rounds']:.0f} rounds for the slowest)")
    print(f"largest difference of x: {found['largest difference']:.2g}")


if __name__ == "__main__":
    main()
