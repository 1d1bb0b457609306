"""Figures like those of the paper's Section V."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from usmbench.model.bernstein import bernstein_basis
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.inverse_map import bezier_abscissa
from usmbench.runs.record import Pairs

COLOURS = {"paper": "C3", "fast": "C0"}


@dataclass(frozen=True, slots=True)
class PointFit:
    """One operating point, fitted by one method; speeds scaled to the highest measured one.

    Parameters
    ----------
    pairs
        The settled pairs.
    speed
        Their scaled speeds, shape (n,).
    curve
        The fitted static curve, scaled likewise.
    error
        Error of each sample, shape (n,).
    sse
        Its sum of squares.
    """

    pairs: Pairs
    speed: NDArray[np.float64]
    curve: StaticCurve
    error: NDArray[np.float64]
    sse: float


def draw_basis(path: Path, knots_deg: tuple[float, ...]) -> None:
    """Draw the Bernstein basis over the phase, as Figs. 7 and 10."""
    knots = np.array(knots_deg)
    phase_deg = np.linspace(knots[0], knots[-1], 1001)
    basis = bernstein_basis(bezier_abscissa(phase_deg, knots), knots.size - 1)
    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    axes = figure.subplots()
    axes.plot(phase_deg, basis, lw=1.0)
    axes.plot(knots, np.zeros(knots.size), "|", color="0.3", ms=9, label="knots Φ")
    axes.set(
        xlabel="phase shift φ (°)",
        ylabel=f"B_j({knots.size - 1})(x(φ))",
        xlim=(knots[0], knots[-1]),
        ylim=(0.0, 1.0),
        title=f"{knots.size} Bernstein functions over the paper's knots",
    )
    axes.legend(loc="upper center", frameon=False)
    figure.savefig(path, dpi=130)


def draw_fit(path: Path, title: str, fits: dict[str, PointFit]) -> None:
    """Draw curve over measured points, and the error per sample beside it, as Figs. 8 to 13."""
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(3.0, 2.0))
    first = next(iter(fits.values()))
    left.plot(
        first.pairs.phase_deg, first.speed, "x", ms=5, color="0.2", label="measured", zorder=3
    )
    phase_deg = np.linspace(first.pairs.phase_deg.min(), first.pairs.phase_deg.max(), 721)
    for method, fit in fits.items():
        style = {"color": COLOURS[method], "lw": 1.2}
        left.plot(phase_deg, fit.curve.speed_rad_s(phase_deg), label=method, **style)
        right.plot(1e3 * fit.error, ".-", ms=4, label=f"{method}, SSE {fit.sse:.3g}", **style)
    right.axhline(0.0, lw=0.6, color="0.3")
    left.set(xlabel="phase shift φ (°)", ylabel="speed over highest speed", title=title)
    right.set(xlabel="sample", ylabel="error (10⁻³ of the highest speed)")
    left.legend(loc="upper left", frameon=False)
    right.legend(loc="upper left", frameon=False)
    right.margins(y=0.25)
    figure.savefig(path, dpi=130)
