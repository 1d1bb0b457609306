"""Where a curve was hardly measured: beyond a drive's last but one, at its ends, by few rows."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.robust_fit import OVER_MEDIAN
from usmbench.model.polygon import hats

Array = NDArray[np.float64]

_ALONE = 4.0  # usual gaps between phases that set an end apart
_HELD, _OPEN_END = 8, 0.05  # rows that hold an end of a curve; share of the highest speed


def short_of_ends_deg(measured_deg: Array) -> list[float]:
    """Return where a drive ends that goes on to its last phases by a jump.

    A warm-up that holds an end is of a colder motor than all the rest.

    Parameters
    ----------
    measured_deg
        Phases that were measured, rising, shape (M,).
    """
    if measured_deg.size < 4:
        return []
    gaps_deg = np.diff(measured_deg)
    alone_deg = _ALONE * float(np.median(gaps_deg))
    ends = zip(measured_deg[[1, -2]], gaps_deg[[0, -1]], strict=True)
    return [float(inner_deg) for inner_deg, gap_deg in ends if gap_deg > alone_deg]


def unheld_rad_s(nodes_deg: Sequence[float], rows_deg: Array, top_rad_s: float) -> Array:
    """Return how far off a curve may be at nodes that have few rows there or farther out.

    A multisine comes to its ends once or twice, which does not tell how the curve saturates.

    Parameters
    ----------
    nodes_deg
        The nodes, rising, shape (K,).
    rows_deg
        Phases of all rows, rising, shape (N,).
    top_rad_s
        Highest speed.

    Returns
    -------
    Array
        Shape (K,).
    """
    up = np.searchsorted(rows_deg, nodes_deg, side="right")
    down = rows_deg.size - np.searchsorted(rows_deg, nodes_deg, side="left")
    held = np.minimum(np.minimum(up, down) / _HELD, 1.0)
    return np.asarray(_OPEN_END * top_rad_s * (1.0 - held))


def by_chance_rad_s(
    nodes_deg: Sequence[float], rows_deg: Array, points: Sequence[Array], residual_rad_s: Array
) -> Array:
    """Return how far off a curve may be at nodes for the scatter of the few rows near each.

    Of several curves, each at an operating point, the one with the fewest counts.

    Parameters
    ----------
    nodes_deg
        The nodes, rising, shape (K,).
    rows_deg
        Phases of all rows, shape (N,).
    points
        Weight of each operating point on these rows, shape (N,) each.
    residual_rad_s
        What the model leaves of them, shape (N,).

    Returns
    -------
    Array
        Shape (K,).
    """
    near = np.array([np.array(points) @ hat for hat in hats(rows_deg, np.array(nodes_deg))])
    scatter_rad_s = OVER_MEDIAN * float(np.median(np.abs(residual_rad_s)))
    return np.asarray(scatter_rad_s / np.sqrt(np.maximum(near.min(axis=1), 1.0)))
