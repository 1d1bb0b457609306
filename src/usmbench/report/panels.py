"""A figure with a panel for each operating point, and the runs' points in it."""

from collections.abc import Iterator
from math import ceil, isnan

import numpy as np
from matplotlib.figure import Figure, SubFigure
from numpy.typing import NDArray

from usmbench.runs.comparison import Comparison
from usmbench.runs.record import Pairs

COLUMNS = 3
MOST_PANELS = 9
Mask = NDArray[np.bool_]


def operating_points(measured: Pairs | Comparison) -> list[tuple[float, float]]:
    """Return the (frequency in Hz, torque in N·m) of settings, in the order of frequencies.

    Parameters
    ----------
    measured
        Settings; NaN stands for a frequency or torque that is not known.
    """
    points = np.column_stack((measured.frequency_hz, measured.torque_nm))
    # With an axis, numpy takes every NaN for another value; infinity equals itself.
    found = np.unique(np.where(np.isnan(points), np.inf, points), axis=0)
    found[np.isinf(found)] = np.nan
    return [(float(f), float(torque)) for f, torque in found]


def at_point(measured: Pairs | Comparison, point: tuple[float, float]) -> Mask:
    """Return which settings belong to an operating point, shape as the columns.

    Parameters
    ----------
    measured
        The settings.
    point
        Frequency in Hz and torque in N·m.
    """
    same: Mask = np.isclose(measured.frequency_hz, point[0], equal_nan=True)
    return same & np.isclose(measured.torque_nm, point[1], equal_nan=True)


def point_title(point: tuple[float, float]) -> str:
    """Return an operating point as a title has it.

    Parameters
    ----------
    point
        Frequency in Hz and torque in N·m.
    """
    frequency_hz, torque_nm = point
    words = []
    if not isnan(frequency_hz):
        words.append(f"{frequency_hz / 1e3:g} kHz")
    if not isnan(torque_nm):
        words.append(f"{torque_nm:g} N·m")
    return ", ".join(words) or "operating point not known"


def left_out(points: list[tuple[float, float]]) -> str:
    """Return the line that says how many operating points have no panel; empty where all have.

    Parameters
    ----------
    points
        The operating points.
    """
    if len(points) <= MOST_PANELS:
        return ""
    return f"\n{MOST_PANELS} of {len(points)} operating points are drawn"


def rows_of(points: list[tuple[float, float]]) -> int:
    """Return how many rows of panels operating points need.

    Parameters
    ----------
    points
        The operating points.
    """
    return ceil(min(len(points), MOST_PANELS) / COLUMNS)


def panels(
    figure: Figure | SubFigure, points: list[tuple[float, float]]
) -> Iterator[tuple[SubFigure, tuple[float, float]]]:
    """Yield a part of a figure for each operating point, as many as are readable.

    Parameters
    ----------
    figure
        The figure to divide.
    points
        The operating points.
    """
    shown = points[:MOST_PANELS]
    n_columns = min(len(shown), COLUMNS)
    parts = figure.subfigures(rows_of(points), n_columns, squeeze=False)
    yield from zip(parts.flat, shown, strict=False)
