"""Free-running error on unseen runs of the simulated motor, beside the noise floor and the peers.

    python benchmarks/identification_free_run.py [--small] [--peers]

One motor is driven through the sweep's own code, after 25 minutes that warm it through. Models are
identified on a staircase and a random telegraph and run free over runs they have not seen: a
staircase at other phases, another telegraph, a multisine. Dwells of the staircases last a second,
at phases that the generator can set (4096 to the turn). Each unseen run is driven several times.
The noise floor is the scatter of a window among those, and the error is that over all of them;
both are printed for the staircase's settled windows as well, five and more after a change of
phase. The motor is no Hammerstein system: it sticks, its torque has a
limit, and its wave is out of balance while the phase changes.
`--peers` adds SysIdentPy and needs the `peers` extra.
"""

import argparse
import time
import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from benchmarks.testbed_runs import excitation, head, measured, staircase
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.lag_family import LagFamily
from usmbench.identify.paper import KNOTS_BOTH_WAYS_DEG, PaperOptions, identify_paper
from usmbench.model.bernstein import bernstein_basis
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.inverse_map import bezier_abscissa
from usmbench.model.linear import fitted_start_rad_s, free_run
from usmbench.model.simulate import simulate
from usmbench.runs.dwells import dwell_begin
from usmbench.runs.record import Record

Array = NDArray[np.float64]
Simulator = Callable[[Record], Array]

SETTLED_AFTER = 5  # windows


def on_grid(phases_deg: Array) -> Array:
    """Return the phases that the generator sets for these."""
    step_deg = 360.0 / 4096.0
    settable: Array = step_deg * np.round(phases_deg / step_deg)
    return settable


def rms(error: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(error**2)))


def settled(record: Record) -> NDArray[np.bool_]:
    """Return the windows five and more after a change of phase."""
    rows = np.arange(record.phase_deg.size)
    late: NDArray[np.bool_] = rows - dwell_begin(record.phase_deg) >= SETTLED_AFTER
    return late


def scatter(repeated: list[Record], rows: NDArray[np.bool_] | slice = slice(None)) -> float:
    """Return the standard deviation of a window among repeated runs, root mean square."""
    speeds = np.array([record.speed_rad_s[rows] for record in repeated])
    return float(np.sqrt(np.mean(speeds.var(axis=0, ddof=1))))


def model_simulator(model: HammersteinModel) -> Simulator:
    """Return the free run of one of our models."""

    def simulator(record: Record) -> Array:
        return simulate(
            model,
            record.phase_deg,
            record.frequency_hz,
            record.torque_nm,
            measured_rad_s=record.speed_rad_s,
        ).speed_rad_s

    return simulator


def plain_least_squares(records: list[Record]) -> Simulator:
    """Fit the same model by scipy.optimize.least_squares, from a straight line, on fixed knots."""
    knots_deg = np.array(KNOTS_BOTH_WAYS_DEG)
    family = LagFamily(3.0)

    def basis(record: Record) -> Array:
        held_deg = np.clip(record.phase_deg, -90.0, 90.0)
        return bernstein_basis(bezier_abscissa(held_deg, knots_deg), knots_deg.size - 1)

    def run(unknowns: Array, columns: Array, record: Record) -> Array:
        linear = family.dynamics(family.moved(unknowns[:2], np.zeros(2))).linear_part(0.01)
        settled_rad_s = columns @ unknowns[2:]
        start_rad_s = fitted_start_rad_s(linear, settled_rad_s, record.speed_rad_s)
        return free_run(linear, settled_rad_s, start_rad_s)

    columns = [basis(record) for record in records]

    def residual(unknowns: Array) -> Array:
        pairs = zip(columns, records, strict=True)
        return np.concatenate(
            [record.speed_rad_s - run(unknowns, c, record) for c, record in pairs]
        )

    start = np.concatenate([[np.log(0.5), 0.5], knots_deg / 9.0])
    best = least_squares(residual, start).x
    return lambda record: run(best, basis(record), record)


def sysidentpy_narx(records: list[Record], kind: str) -> Simulator:
    """Fit a NARX model of SysIdentPy by FROLS with 20 terms, on data scaled into [0, 1]."""
    from sysidentpy.basis_function import Bernstein, Polynomial
    from sysidentpy.model_structure_selection import FROLS
    from sysidentpy.parameter_estimation import LeastSquares

    def scaled(record: Record) -> tuple[Array, Array]:
        held_deg = np.clip(record.phase_deg, -90.0, 90.0)
        return (held_deg[:, None] + 90.0) / 180.0, (record.speed_rad_s[:, None] + 15.0) / 30.0

    basis = Bernstein(degree=6) if kind == "Bernstein" else Polynomial(degree=5)
    model = FROLS(
        order_selection=False,
        n_terms=20,
        ylag=1,
        xlag=2,
        estimator=LeastSquares(),
        basis_function=basis,
    )
    parts = [scaled(record) for record in records]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model.fit(X=np.vstack([p[0] for p in parts]), y=np.vstack([p[1] for p in parts]))

    def simulator(record: Record) -> Array:
        x, y = scaled(record)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            predicted = model.predict(X=x, y=y[:2])
        return np.asarray(predicted, dtype=np.float64).ravel()[: y.size] * 30.0 - 15.0

    return simulator


def compare(small: bool, with_peers: bool) -> dict[str, dict[str, float]]:
    """Return the free-running RMSE over the noise floor, by method and unseen run."""
    windows, duration_s, warm_up_s = (20, 10.0, 2) if small else (100, 40.0, 1500)
    repeats = 2 if small else 4
    fine = np.concatenate([np.arange(-90, -12, 5), np.arange(-12, 12.5, 1), np.arange(15, 91, 5)])
    warm = head(warm_up_s=10)
    unseen_plans = {
        "staircase": warm + staircase(on_grid(np.linspace(-88.0, 88.0, 41)), windows),
        "telegraph": warm + excitation("telegraph", 5, duration_s),
        "multisine": warm + excitation("multisine", 5, duration_s),
    }
    plans = [
        head(warm_up_s=warm_up_s) + staircase(on_grid(fine), windows),
        warm + excitation("telegraph", 1, duration_s),
        *(plan for _ in range(repeats) for plan in unseen_plans.values()),
    ]
    runs = measured(plans, 1)
    training = runs[:2]
    unseen = {name: runs[2 + k :: len(unseen_plans)] for k, name in enumerate(unseen_plans)}
    methods: dict[str, Callable[[], Simulator]] = {
        "fast": lambda: model_simulator(identify_fast(training, FastOptions()).model),
        "paper (staircase pairs)": lambda: model_simulator(
            identify_paper(training[:1], PaperOptions(degree=18)).found.model
        ),
        "scipy least_squares": lambda: plain_least_squares(training),
    }
    if with_peers:
        methods["SysIdentPy, Bernstein NARX"] = lambda: sysidentpy_narx(training, "Bernstein")
        methods["SysIdentPy, polynomial NARX"] = lambda: sysidentpy_narx(training, "polynomial")
    still = settled(unseen["staircase"][0])
    floors = {name: scatter(repeated) for name, repeated in unseen.items()}
    floors["settled"] = scatter(unseen["staircase"], still)
    table: dict[str, dict[str, float]] = {"noise floor, rad/s": floors}
    for method, fit in methods.items():
        begun_s = time.process_time()
        simulator = fit()
        took_s = time.process_time() - begun_s
        ratios = {}
        for name, repeated in unseen.items():
            error = np.array([record.speed_rad_s - simulator(record) for record in repeated])
            ratios[name] = rms(error) / floors[name]
            if name == "staircase":
                ratios["settled"] = rms(error[:, still]) / floors["settled"]
        table[method] = {**ratios, "fit, s": took_s}
    return table


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--small", action="store_true", help="short runs")
    parser.add_argument("--peers", action="store_true", help="with SysIdentPy")
    args = parser.parse_args()
    table = compare(args.small, args.peers)
    names = ["staircase", "settled", "telegraph", "multisine", "fit, s"]
    print(f"{'free-running RMSE over the floor':34}" + "".join(f"{name:>12}" for name in names))
    for method, row in table.items():
        print(
            f"{method:34}"
            + "".join(f"{row[name]:12.4g}" if name in row else f"{'':12}" for name in names)
        )


if __name__ == "__main__":
    main()
