"""The plot of ``usmbench compare``: both curves, and what lies between them."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from usmbench.report.drawing import PASSES, save_figure
from usmbench.report.panels import (
    COLUMNS,
    Mask,
    at_point,
    left_out,
    operating_points,
    panels,
    point_title,
    rows_of,
)
from usmbench.report.plain_text import short_name
from usmbench.runs.comparison import Comparison


def write_comparison_plot(path: Path, comparison: Comparison, names: tuple[str, str]) -> None:
    """Write the plot in the format that the file's name asks for.

    Parameters
    ----------
    path
        The file: .png, .svg, .pdf.
    comparison
        What both runs measured.
    names
        Names of the first run and of the second.

    Raises
    ------
    usmbench.errors.InputError
        The file cannot be written, or its format is unknown.
    """
    points = operating_points(comparison)
    width = 9.0 if len(points) == 1 else 5.0 * min(len(points), COLUMNS)
    figure = Figure(figsize=(width, 6.5 * rows_of(points)), layout="constrained")
    first, second = (short_name(name) for name in names)
    figure.suptitle(f"A: {first}\nB: {second}{left_out(points)}", parse_math=False)
    for part, point in panels(figure, points):
        top, bottom = part.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
        here = at_point(comparison, point)
        top.set_title(point_title(point))
        _draw_curves(top, comparison, here)
        _draw_difference(bottom, comparison, here)
    save_figure(figure, path)


def _draw_curves(axes: Axes, comparison: Comparison, here: Mask) -> None:
    """Draw both runs: A hollow, B filled, so that they are told apart in grey."""
    runs = (
        ("A", comparison.first_rad_s, 7.0, "none", "0.45"),
        ("B", comparison.second_rad_s, 3.5, "0.1", "0.1"),
    )
    for run, speed_rad_s, size, face, edge in runs:
        for direction, marker, label, _ in PASSES:
            chosen = here & (comparison.direction == direction)
            axes.plot(
                comparison.phase_deg[chosen],
                speed_rad_s[chosen],
                marker=marker,
                ls="none",
                label=f"{run}, {label}",
                ms=size,
                mfc=face,
                color=edge,
            )
    axes.set_ylabel("settled speed ω (rad/s)")
    axes.grid(color="0.9", lw=0.6)
    axes.legend(loc="upper left", frameon=False)


def _draw_difference(axes: Axes, comparison: Comparison, here: Mask) -> None:
    for direction, marker, label, shade in PASSES:
        chosen = here & (comparison.direction == direction)
        axes.errorbar(
            comparison.phase_deg[chosen],
            comparison.difference_rad_s[chosen],
            comparison.std_rad_s[chosen],
            fmt=marker,
            ms=4.5,
            mfc="none",
            color=shade,
            elinewidth=0.8,
            label=label,
        )
    axes.axhline(0.0, lw=0.6, color="0.3")
    axes.set(xlabel="phase shift φ (°)", ylabel="B − A (rad/s)")
    axes.grid(color="0.9", lw=0.6)
