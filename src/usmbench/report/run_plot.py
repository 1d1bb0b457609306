"""The plot of ``usmbench show``: settled speed over phase, and speed and phase over time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from usmbench.report.drawing import CURVE_POINTS, PASSES, save_figure, shown_time
from usmbench.report.panels import (
    at_point,
    left_out,
    operating_points,
    panels,
    point_title,
    rows_of,
)
from usmbench.report.plain_text import short_name
from usmbench.report.thinning import thinned
from usmbench.runs.record import Pairs, Record

if TYPE_CHECKING:  # importing a model takes longer than to draw the run
    from usmbench.model.hammerstein import HammersteinModel, OperatingPoint

# Twice the pixels of a wide screen: more columns would draw over each other.
_LINE_COLUMNS = 4000


def write_run_plot(path: Path, record: Record, model: HammersteinModel | None = None) -> None:
    """Write the plot in the format that the file's name asks for.

    Parameters
    ----------
    path
        The file: .png, .svg, .pdf.
    record
        The run.
    model
        A model whose curve is drawn beside the pairs, or None.

    Raises
    ------
    usmbench.errors.InputError
        The file cannot be written, or its format is unknown.
    """
    points = [] if record.pairs is None else operating_points(record.pairs)
    n_rows = rows_of(points)
    figure = Figure(figsize=(10.0, 4.0 + 4.0 * n_rows), layout="constrained")
    figure.suptitle(short_name(record.name) + left_out(points), parse_math=False)
    if record.pairs is None:
        _draw_time(figure, record)
    else:
        top, bottom = figure.subfigures(2, 1, squeeze=False, height_ratios=(n_rows, 0.9)).flat
        for part, point in panels(top, points):
            _draw_curve(part.subplots(), record.pairs, point, _model_point(model, point))
        _draw_time(bottom, record)
    save_figure(figure, path)


def _draw_curve(
    axes: Axes, pairs: Pairs, point: tuple[float, float], fitted: OperatingPoint | None
) -> None:
    """Draw the settled pairs of one operating point, and the model's curve."""
    here = at_point(pairs, point)
    if fitted is not None:
        phase_deg = np.linspace(*fitted.phase_range_deg, CURVE_POINTS)
        axes.plot(phase_deg, fitted.curve.speed_rad_s(phase_deg), "C0", lw=1.3, label="model")
    for direction, marker, label, shade in PASSES:
        chosen = here & (pairs.direction == direction)
        axes.plot(
            pairs.phase_deg[chosen],
            pairs.speed_rad_s[chosen],
            marker,
            ms=4.5,
            color=shade,
            mfc="none",
            label=label,
        )
    axes.set(xlabel="phase shift φ (°)", ylabel="settled speed ω (rad/s)")
    axes.set_title(point_title(point))
    axes.grid(color="0.9", lw=0.6)
    axes.legend(loc="upper left", frameon=False)


def _model_point(
    model: HammersteinModel | None, point: tuple[float, float]
) -> OperatingPoint | None:
    """Return the model's curve at an operating point, None where it has none."""
    if model is None:
        return None
    for fitted in model.points:
        known = (fitted.frequency_hz, fitted.torque_nm)
        if all(
            value is None or np.isnan(wanted) or np.isclose(value, wanted)
            for value, wanted in zip(known, point, strict=True)
        ):
            return fitted
    return None


def _draw_time(figure: Figure | SubFigure, record: Record) -> None:
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1.6, 1.0))
    t_s, label = shown_time(record)
    top.plot(*thinned(t_s, record.speed_rad_s, _LINE_COLUMNS), color="0.15", lw=0.8)
    bottom.plot(t_s, record.phase_deg, color="0.15", lw=0.8, drawstyle="steps-pre")
    top.set_ylabel("speed ω (rad/s)")
    bottom.set(xlabel=label, ylabel="phase φ (°)")
    for axes in (top, bottom):
        axes.grid(color="0.9", lw=0.6)
        axes.margins(x=0.01)
