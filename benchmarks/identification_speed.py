"""Time to fit and to run free, beside SysIdentPy with as many terms.

    python benchmarks/identification_speed.py [--small] [--peers]

The record is a random-phase run of a known Hammerstein motor, five windows a dwell. SysIdentPy's
FROLS selects 22 terms, as many as our model of degree 18 has parameters, from a Bernstein basis of
the lagged speed and phase, and fits them to one step ahead by least squares. Ours is fitted to the
free run: dead time and dynamics searched, rows weighted against outliers, a torque limit looked
for, the residual tested and intervals given; on the paper's knots, with the knots of degree 18
chosen on held-out blocks, and with the degree chosen as well. Times are CPU time of one process,
best of several; set OPENBLAS_NUM_THREADS=1. `--peers` needs the `peers` extra.
"""

import argparse
import time
import warnings
from collections.abc import Callable
from typing import Any

from benchmarks.identification_coverage import record
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.paper import KNOTS_BOTH_WAYS_DEG
from usmbench.model.simulate import simulate

FITS = {
    "knots given": FastOptions(knots_deg=KNOTS_BOTH_WAYS_DEG),
    "degree 18": FastOptions(degree=18),
    "all chosen": FastOptions(),
}
TERMS = 22  # a_1, the three b of a lag with a dead time less its unit gain, 19 ordinates


def best_s(call: Callable[[], Any], repeats: int) -> float:
    """Return the least CPU time of several calls."""
    times_s = []
    for _ in range(repeats):
        begun_s = time.process_time()
        call()
        times_s.append(time.process_time() - begun_s)
    return min(times_s)


def ours(n: int, repeats: int, options: FastOptions) -> tuple[float, float]:
    """Return our times to fit and to run free."""
    run = record(1, n, 0.0)
    model = identify_fast([run], options).model
    fit_s = best_s(lambda: identify_fast([run], options), repeats)
    return fit_s, best_s(lambda: simulate(model, run.phase_deg), repeats)


def sysidentpy(n: int, repeats: int) -> tuple[float, float]:
    """Return SysIdentPy's times to fit and to run free."""
    from sysidentpy.basis_function import Bernstein
    from sysidentpy.model_structure_selection import FROLS
    from sysidentpy.parameter_estimation import LeastSquares

    run = record(1, n, 0.0)
    x = (run.phase_deg[:, None] + 90.0) / 180.0
    y = (run.speed_rad_s[:, None] + 15.0) / 30.0

    def fitted() -> Any:
        model = FROLS(
            order_selection=False,
            n_terms=TERMS,
            ylag=1,
            xlag=2,
            estimator=LeastSquares(),
            basis_function=Bernstein(degree=8),
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return model.fit(X=x, y=y)

    def free_run(model: Any) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model.predict(X=x, y=y[:2])

    model = fitted()
    fit_s = best_s(fitted, min(repeats, 3))
    return fit_s, best_s(lambda: free_run(model), 1)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="2000 rows, once")
    parser.add_argument("--peers", action="store_true", help="with SysIdentPy")
    args = parser.parse_args()
    sizes, repeats = ((2000,), 1) if args.small else ((10_000, 100_000), 7)
    print(f"{'rows':>8} {'':24} {'fit':>11} {'free run':>12}  SysIdentPy's time over it")
    for n in sizes:
        peer_s = sysidentpy(n, repeats) if args.peers else None
        times_s = {f"ours, {name}": ours(n, repeats, chosen) for name, chosen in FITS.items()}
        for name, (fit_s, run_s) in times_s.items():
            over = "" if peer_s is None else f"{peer_s[0] / fit_s:6.1f} {peer_s[1] / run_s:6.0f}"
            print(f"{n:8d} {name:24} {fit_s:9.4f} s {1e3 * run_s:9.2f} ms  {over}", flush=True)
        if peer_s is not None:
            print(f"{n:8d} {'SysIdentPy':24} {peer_s[0]:9.4f} s {1e3 * peer_s[1]:9.2f} ms")


if __name__ == "__main__":
    main()
