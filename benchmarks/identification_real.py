"""Records that others have measured: held-out free-run error beside a linear model's.

    python benchmarks/identification_real.py --data DIR

DIR holds `dc-motor-dead-zone/run_minimal.csv` (a DC motor with a dead zone, by the voltage;
Piyushiitk24/dc-motor-signed-bias-deadzone-id-control on GitHub, commit 1988dae) and
`coupled-drives/DATAUNIF.csv` (Wigren and Schoukens, Coupled Electric Drives Data Set, TR 2017-024,
Uppsala University). Neither states a licence, so neither is part of usmbench. The input, in volts,
stands where the phase does. The linear model is the same output-error fit with a straight line for
a curve. Errors are root mean squares over rows that no fit has seen, in the record's own unit.
"""

import argparse
import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.simulate import simulate
from usmbench.runs.record import Record

Array = NDArray[np.float64]

ORDERS = ((1, None), (2, 1), (3, 2))


@dataclass(frozen=True, slots=True)
class Split:
    """A record, and which rows no fit sees.

    Parameters
    ----------
    name, unit
        What it is, and the unit of its output.
    record
        All rows; the input stands in `phase_deg`.
    held
        True on the held-out rows.
    """

    name: str
    unit: str
    record: Record
    held: NDArray[np.bool_]


def columns(path: Path) -> dict[str, Array]:
    """Return the columns of a CSV file that hold numbers."""
    with path.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    names = [name for name in rows[0] if name and _is_number(rows[0][name])]
    return {name: np.array([float(row[name]) for row in rows]) for name in names}


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def splits(folder: Path) -> list[Split]:
    """Return the records: the motor's later dwells at 2 and 6 V, the drives' last 100 rows held."""
    motor = columns(folder / "dc-motor-dead-zone" / "run_minimal.csv")
    drives = columns(folder / "coupled-drives" / "DATAUNIF.csv")
    voltage, later = motor["voltage"], motor["time"] >= 33.0
    dwells = later & np.isin(np.abs(voltage), [2.0, 6.0])
    found = [_split("DC motor", "rpm", voltage, motor["rpm"], 0.01, dwells)]
    for k in ("1", "2"):
        u, z = drives[f"u1{k}"], drives[f"z1{k}"]
        last = np.arange(u.size) >= u.size - 100
        found.append(_split(f"coupled drives, z1{k}", "ticks/s", u, z, 0.02, last))
    return found


def _split(
    name: str, unit: str, u: Array, y: Array, step_s: float, held: NDArray[np.bool_]
) -> Split:
    t_s = step_s * np.arange(1.0, u.size + 1.0)
    return Split(name, unit, Record(name, t_s, u, y, np.full(u.size, step_s)), held)


def fitted(split: Split, degree: int | None, orders: tuple[int, int | None]) -> HammersteinModel:
    """Fit the rows that are not held out; the run is cut where they are missing."""
    r, rows = split.record, ~split.held
    part = Record(r.name, r.t_s[rows], r.phase_deg[rows], r.speed_rad_s[rows], r.window_s[rows])
    return identify_fast([part], FastOptions(degree=degree, na=orders[0], nb=orders[1])).model


def error(split: Split, model: HammersteinModel, rows: NDArray[np.bool_]) -> float:
    """Return the error of a free run through the whole record, on some of its rows."""
    run, curve = split.record, model.points[0].curve
    within = np.clip(run.phase_deg, curve.knots_deg[0], curve.knots_deg[-1])
    simulated = simulate(model, within, measured_rad_s=run.speed_rad_s).speed_rad_s
    return float(np.sqrt(np.mean((run.speed_rad_s - simulated)[rows] ** 2)))


def held_out(split: Split, degree: int | None) -> tuple[float, str]:
    """Return the held-out error of the orders that run best over the fitted rows."""
    models = {orders: fitted(split, degree, orders) for orders in ORDERS}
    best = min(models, key=lambda orders: error(split, models[orders], ~split.held))
    label = "lag with dead time" if best[1] is None else f"n_a {best[0]}, n_b {best[1]}"
    return error(split, models[best], split.held), label


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, metavar="DIR")
    args = parser.parse_args()
    print(f"{'record':22} {'Hammerstein':>12} {'linear':>10}")
    for split in splits(args.data):
        own, orders = held_out(split, None)
        linear, linear_orders = held_out(split, 1)
        print(
            f"{split.name:22} {own:12.4g} {linear:10.4g} {split.unit:8} "
            f"({orders}; linear: {linear_orders})",
            flush=True,
        )


if __name__ == "__main__":
    main()
