"""Section V of Mojallali and Ahmadi (2011) on the simulated testbed, all nine operating points.

    python examples/reproduce_paper/reproduce.py [--out DIR]

Sweeps 41, 41.5 and 42 kHz at 0, 0.1 and 0.2 N·m, identifies each by the paper's algorithm and by
the method that is usmbench's default, draws figures like the paper's, and prints the sums of
squares beside the paper's. Runs that are in DIR already are taken as they are. Give --bench a
bench file to measure a motor of your own.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from figures import PointFit, draw_basis, draw_fit
from numpy.typing import NDArray

from usmbench.cli.main import main as usmbench
from usmbench.errors import InputError
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.paper import (
    KNOTS_BOTH_WAYS_DEG,
    KNOTS_ONE_WAY_DEG,
    PaperOptions,
    identify_paper,
)
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint
from usmbench.runs.reader import read_run
from usmbench.runs.record import Pairs, Record

HERE = Path(__file__).resolve().parent
PLANS = ("plan-41khz.yaml", "plan-41.5-and-42khz.yaml")
FREQUENCIES_HZ = (41_000.0, 41_500.0, 42_000.0)
TORQUES_NM = (0.0, 0.1, 0.2)
PAPER_SSE = 5.35e-5
# The paper's figure of each operating point: curve, and error where it is a figure of its own.
FIGURES = {
    (41_000.0, 0.0): "fig08a-09a",
    (41_000.0, 0.1): "fig08b-09b",
    (41_000.0, 0.2): "fig08c-09c",
    (41_500.0, 0.0): "fig11a",
    (42_000.0, 0.0): "fig11b",
    (41_500.0, 0.1): "fig12a",
    (42_000.0, 0.1): "fig12b",
    (41_500.0, 0.2): "fig13a",
    (42_000.0, 0.2): "fig13b",
}


def measured(folder: Path, bench: str) -> list[Record]:
    """Drive both plans, or read the runs where they have been driven before."""
    records = []
    for plan in PLANS:
        run = folder / Path(plan).with_suffix("").name
        if not run.exists():
            status = usmbench(["sweep", str(HERE / plan), "--bench", bench, "--out", str(run)])
            if status != 0:
                raise SystemExit(status)
        records.append(read_run(run))
    return records


def at_point(record: Record, frequency_hz: float, torque_nm: float) -> Record | None:
    """Return the pairs of one operating point, scaled to a highest speed of 1."""
    pairs = record.pairs
    if pairs is None:
        return None
    chosen = (pairs.frequency_hz == frequency_hz) & (pairs.torque_nm == torque_nm)
    if not chosen.any():
        return None
    columns = {name: getattr(pairs, name)[chosen] for name in Pairs.__slots__}
    columns["speed_rad_s"] = columns["speed_rad_s"] / np.max(np.abs(columns["speed_rad_s"]))
    return replace(record, pairs=Pairs(**columns))


def fitted_by_paper(record: Record) -> PointFit:
    """Identify one operating point by the paper's algorithm, knots and degree of its Section V."""
    pairs = record.pairs
    if pairs is None:
        raise InputError(f"{record.name} has no settled pairs")
    both_ways = float(pairs.phase_deg.min()) < 0.0
    knots = KNOTS_BOTH_WAYS_DEG if both_ways else KNOTS_ONE_WAY_DEG
    result = identify_paper([record], PaperOptions(knots_deg=knots, seed=1))
    point, linear = result.found.model.points[0], result.found.model.linear
    speed = pairs.speed_rad_s
    settled = point.curve.speed_rad_s(pairs.phase_deg)
    # Eq. (15): one step ahead of the measured pair before; the first pair has none.
    predicted = linear.b[0] * settled[1:] - linear.a[0] * speed[:-1]
    error = np.concatenate([[0.0], speed[1:] - predicted])
    return PointFit(pairs, speed, point.curve, error, float(error @ error))


def fitted_by_default(point: OperatingPoint, record: Record, top_rad_s: float) -> PointFit:
    """Hold the default method's curve against the same pairs."""
    pairs = record.pairs
    if pairs is None:
        raise InputError(f"{record.name} has no settled pairs")
    curve = replace(point.curve, delta=point.curve.delta / top_rad_s)
    error: NDArray[np.float64] = pairs.speed_rad_s - curve.speed_rad_s(pairs.phase_deg)
    return PointFit(pairs, pairs.speed_rad_s, curve, error, float(error @ error))


def point_of(model: HammersteinModel, frequency_hz: float, torque_nm: float) -> OperatingPoint:
    """Return a model's operating point."""
    return next(
        point
        for point in model.points
        if (point.frequency_hz, point.torque_nm) == (frequency_hz, torque_nm)
    )


def reproduce(folder: Path, bench: str) -> list[str]:
    """Measure, identify, draw; return the table's lines."""
    records = measured(folder, bench)
    draw_basis(folder / "fig07.png", KNOTS_BOTH_WAYS_DEG)
    draw_basis(folder / "fig10.png", KNOTS_ONE_WAY_DEG)
    model = identify_fast(records, FastOptions()).model
    lines = [f"{'frequency':>10} {'torque':>8} {'pairs':>6} {'SSE, paper':>12} {'SSE, fast':>12}"]
    for frequency_hz in FREQUENCIES_HZ:
        for torque_nm in TORQUES_NM:
            record = next(
                found
                for found in (at_point(r, frequency_hz, torque_nm) for r in records)
                if found is not None
            )
            top_rad_s = highest_speed_rad_s(records, frequency_hz, torque_nm)
            paper = fitted_by_paper(record)
            own = fitted_by_default(point_of(model, frequency_hz, torque_nm), record, top_rad_s)
            name = FIGURES[frequency_hz, torque_nm]
            title = f"{frequency_hz / 1e3:g} kHz, {torque_nm:g} N·m"
            draw_fit(folder / f"{name}.png", title, {"paper": paper, "fast": own})
            lines.append(
                f"{frequency_hz / 1e3:6g} kHz {torque_nm:4g} N·m {paper.error.size:6d} "
                f"{paper.sse:12.3g} {own.sse:12.3g}"
            )
    return [*lines, f"{'the paper, 41 kHz':>26} {PAPER_SSE:12.3g}"]


def highest_speed_rad_s(records: list[Record], frequency_hz: float, torque_nm: float) -> float:
    """Return the highest settled speed at an operating point, which is the unit of its speeds."""
    speeds = [
        float(np.max(np.abs(pairs.speed_rad_s[chosen])))
        for pairs in (record.pairs for record in records)
        if pairs is not None
        and (chosen := (pairs.frequency_hz == frequency_hz) & (pairs.torque_nm == torque_nm)).any()
    ]
    return max(speeds)


def main() -> None:
    """Run it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("reproduce-paper"), metavar="DIR")
    parser.add_argument("--bench", default="simulated", metavar="BENCH.yaml")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    lines = reproduce(args.out, args.bench)
    print("\n".join(lines))
    print(f"figures are in {args.out}")


if __name__ == "__main__":
    main()
