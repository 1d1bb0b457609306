"""The report's figures: runs measured against simulated, and the residual against each quantity."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.result import LoneView, Trace, View
from usmbench.report.diagnosis_svg import Axis, Panel, data_range, drawing
from usmbench.report.thinning import thinned

Array = NDArray[np.float64]

_LEFT_PX = 68.0
_RIGHT_PX = 8.0
_VIEW_PX = (340.0, 230.0)
_MOST_MARKS = 1000  # more are one blot
# A few windows at large steps of φ would flatten all others: their residual is cut at the edge.
_BEYOND = 0.004
# Text keeps its size on a telephone only if the drawing is made for its width.
_WIDTHS_PX = {"wide": 1000.0, "narrow": 360.0}
_MARKS: dict[str, Literal["circle", "square"]] = {"before": "circle", "after": "square"}


def trace_figure(trace: Trace, *, extended: bool) -> str:
    """Return a run's speed and what each simulation leaves of it, for wide and narrow pages.

    Parameters
    ----------
    trace
        The run.
    extended
        Whether there is an extended simulation to show.
    """
    return "".join(_trace(trace, style, extended) for style in _WIDTHS_PX)


def _trace(trace: Trace, style: str, extended: bool) -> str:
    """Draw a run: speeds above, residuals below."""
    width_px = _WIDTHS_PX[style]
    x = Axis(*_time_range(trace.t_s), _LEFT_PX, width_px - _RIGHT_PX)
    speeds = [(trace.measured_rad_s, "measured"), (trace.simulated_rad_s, "before")]
    left = [(trace.measured_rad_s - trace.simulated_rad_s, "before dense")]
    if extended:
        speeds.append((trace.extended_rad_s, "after"))
        left.append((trace.measured_rad_s - trace.extended_rad_s, "after dense"))
    above = Panel(x, _upward(speeds, 0.0, 230.0, 10.0), "", "speed (rad/s)")
    below = Panel(x, _upward(left, _BEYOND, 410.0, 250.0), "time (s)", "residual (rad/s)")
    columns = int(0.75 * width_px)
    parts = []
    for panel, series in ((above, speeds), (below, left)):
        parts.append(panel.frame())
        for values, kind in series:
            shown = np.clip(values, panel.y.low, panel.y.high)
            parts.append(panel.line(*thinned(trace.t_s, shown, columns), kind))
    title = f"Measured and simulated speed of {trace.name} against time, and their difference"
    return drawing(width_px, 450.0, title, parts, style)


def _time_range(t_s: Array) -> tuple[float, float]:
    """Return the run's first and last time, never the same."""
    low_s, high_s = float(np.min(t_s)), float(np.max(t_s))
    return (low_s, high_s) if high_s > low_s else (low_s, low_s + 1.0)


def _upward(
    series: list[tuple[Array, str]], beyond: float, bottom_px: float, top_px: float
) -> Axis:
    """Return an axis that holds all series but for a share at either end."""
    held = [
        np.quantile(values[np.isfinite(values)], [beyond, 1.0 - beyond]) for values, _ in series
    ]
    return Axis(*data_range(*held), bottom_px, top_px)


def axis_label(view: View) -> str:
    """Return quantity and unit of a view; what follows a comma in its label is for the caption.

    Parameters
    ----------
    view
        The view.
    """
    return view.label.partition(", ")[0]


def view_figure(view: View, *, extended: bool) -> str:
    """Return the mean residual against one quantity, with its band.

    Parameters
    ----------
    view
        The view.
    extended
        Whether there is an extended simulation to show.
    """
    width_px, height_px = _VIEW_PX
    shown = [view.before_rad_s, -view.band_rad_s, view.band_rad_s]
    if extended:
        shown.append(view.after_rad_s)
    x = Axis(*data_range(view.centre), _LEFT_PX, width_px - _RIGHT_PX)
    y = Axis(*data_range(*shown), height_px - 42.0, 8.0)
    panel = Panel(x, y, axis_label(view), "mean residual (rad/s)")
    parts = [
        panel.band(view.centre, -view.band_rad_s, view.band_rad_s, "band"),
        panel.frame(),
        panel.line(np.array([x.low, x.high]), np.zeros(2), "zero"),
        panel.line(view.centre, view.before_rad_s, "before"),
        panel.marks(view.centre, view.before_rad_s, _MARKS["before"], "before mark"),
    ]
    if extended:
        parts.append(panel.line(view.centre, view.after_rad_s, "after"))
        parts.append(panel.marks(view.centre, view.after_rad_s, _MARKS["after"], "after mark"))
    return drawing(width_px, height_px, f"Mean residual against {view.label}", parts, "view")


def marks_figure(view: LoneView) -> str:
    """Return a mark for each window that stands alone.

    Parameters
    ----------
    view
        The windows; of many, some of them evenly picked.
    """
    width_px, height_px = _VIEW_PX
    rows = np.unique(np.linspace(0, view.at.size - 1, min(view.at.size, _MOST_MARKS)).astype(int))
    x = Axis(*data_range(view.at), _LEFT_PX, width_px - _RIGHT_PX)
    y = Axis(*data_range(view.off_rad_s, np.zeros(1)), height_px - 42.0, 8.0)
    panel = Panel(x, y, view.label, "off by (rad/s)")
    parts = [
        panel.frame(),
        panel.line(np.array([x.low, x.high]), np.zeros(2), "zero"),
        panel.marks(view.at[rows], view.off_rad_s[rows], _MARKS["before"], "before mark"),
    ]
    title = f"Windows that stand alone: how far off they are, against {view.label}"
    return drawing(width_px, height_px, title, parts, "view")


def legend(*entries: tuple[str, str]) -> str:
    """Return a legend.

    Parameters
    ----------
    *entries
        (class in the style sheet, what it stands for) of each.
    """
    items = []
    for style, label in entries:
        shape = "M0 2H34V12H0Z" if style == "band" else "M0 7H34"
        swatch = f'<path class="{style}" d="{shape}"/>'
        if style.endswith("marked"):
            kind, panel = style.split()[0], Panel(Axis(0, 34, 0, 34), Axis(0, 14, 0, 14), "", "")
            swatch = f'<path class="{kind}" d="{shape}"/>'
            swatch += panel.marks(np.array([17.0]), np.array([7.0]), _MARKS[kind], f"{kind} mark")
        items.append(f'<li><svg viewBox="0 0 34 14" aria-hidden="true">{swatch}</svg>{label}</li>')
    return f'<ul class="legend">{"".join(items)}</ul>'
