"""Measured pairs, the fitted static curve over them, and what lies between."""

from math import nan
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from usmbench.errors import InputError
from usmbench.model.hammerstein import OperatingPoint
from usmbench.report.drawing import CURVE_POINTS, PASSES, save_figure
from usmbench.report.panels import at_point, point_title
from usmbench.runs.record import Pairs


def write_curve_plot(path: Path, pairs: Pairs, point: OperatingPoint) -> None:
    """Write the plot in the format that the file's name asks for.

    Parameters
    ----------
    path
        The file: .png, .svg, .pdf.
    pairs
        Settled pairs, of which those at the operating point are drawn.
    point
        The operating point with its curve.

    Raises
    ------
    usmbench.errors.InputError
        No pair belongs to the operating point, or the file cannot be written.
    """
    frequency_hz, torque_nm = (
        nan if value is None else value for value in (point.frequency_hz, point.torque_nm)
    )
    here = at_point(pairs, (frequency_hz, torque_nm))
    low_deg, high_deg = point.phase_range_deg
    here &= (pairs.phase_deg >= low_deg) & (pairs.phase_deg <= high_deg)
    if not here.any():
        raise InputError("no settled pair belongs to the model's operating point", file=path)
    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3.0, 1.0))
    phase_deg = np.linspace(low_deg, high_deg, CURVE_POINTS)
    top.plot(
        phase_deg, point.curve.speed_rad_s(phase_deg), color="C0", lw=1.3, label="fitted curve"
    )
    for direction, marker, label, shade in PASSES:
        chosen = here & (pairs.direction == direction)
        measured, phases = pairs.speed_rad_s[chosen], pairs.phase_deg[chosen]
        style = {"marker": marker, "ls": "none", "ms": 4.5, "color": shade, "mfc": "none"}
        top.plot(phases, measured, label=f"measured, {label}", **style)
        bottom.plot(phases, measured - point.curve.speed_rad_s(phases), **style)
    left_deg, right_deg = point.dead_zone_deg
    if left_deg is not None and right_deg is not None:
        top.axvspan(left_deg, right_deg, color="0.9", lw=0, label="dead zone")
    bottom.axhline(0.0, lw=0.6, color="0.3")
    top.set_ylabel("speed ω (rad/s)")
    bottom.set_ylabel("residual (rad/s)")
    bottom.set_xlabel("phase shift φ (°)")
    top.set_title(point_title((frequency_hz, torque_nm)))
    top.legend(loc="upper left", frameon=False)
    save_figure(figure, path)
