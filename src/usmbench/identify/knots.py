"""Where the knots go: close together where the curve bends, at the edges of the dead zone."""

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import StaticCurve

Array = NDArray[np.float64]

_GRID = 4001


def place_knots(
    low_deg: float,
    high_deg: float,
    degree: int,
    edges_deg: tuple[float, ...] = (),
    share: float = 0.0,
    width_deg: float = 5.0,
) -> Array:
    """Return knots whose density is even plus a hump at each edge.

    Parameters
    ----------
    low_deg, high_deg
        Ends of the curve.
    degree
        Degree d.
    edges_deg
        Where to gather knots.
    share
        Share of the knots in the humps, 0 up to but not including 1.
    width_deg
        Width (standard deviation) of a hump.

    Returns
    -------
    Array
        Strictly rising knots from `low_deg` to `high_deg`, shape (d + 1,).
    """
    grid_deg = np.linspace(low_deg, high_deg, _GRID)
    density = np.full(_GRID, (1.0 - share) / (high_deg - low_deg))
    for edge_deg in edges_deg:
        hump = np.exp(-0.5 * ((grid_deg - edge_deg) / width_deg) ** 2)
        density += share / len(edges_deg) * hump / np.trapezoid(hump, grid_deg)
    mass = np.r_[0.0, np.cumsum(0.5 * (density[1:] + density[:-1]))]
    knots_deg: Array = np.interp(np.linspace(0.0, mass[-1], degree + 1), mass, grid_deg)
    knots_deg[0], knots_deg[-1] = low_deg, high_deg
    return knots_deg


def dead_zone_deg(curve: StaticCurve, threshold_rad_s: float) -> tuple[float | None, float | None]:
    """Return the edges of the stretch about standstill in which the motor does not move.

    Parameters
    ----------
    curve
        The settled speed.
    threshold_rad_s
        Speed (absolute) that still counts as standing.

    Returns
    -------
    low, high
        Last phases at which the curve is within the threshold, below and above the phase of
        least speed; None where the curve ends before it leaves the threshold.
    """
    grid_deg = np.linspace(curve.knots_deg[0], curve.knots_deg[-1], _GRID)
    speed_rad_s = curve.speed_rad_s(grid_deg)
    moving = np.abs(speed_rad_s) > threshold_rad_s
    if np.all(moving):
        return None, None
    standing = np.flatnonzero(~moving)
    middle = int(standing[np.argmin(np.abs(grid_deg[standing]))])
    below = np.flatnonzero(moving[:middle])
    above = np.flatnonzero(moving[middle:])
    low = None if below.size == 0 else int(below[-1])
    high = None if above.size == 0 else middle + int(above[0])
    return (
        None if low is None else _crossing(grid_deg, speed_rad_s, low, low + 1, threshold_rad_s),
        None if high is None else _crossing(grid_deg, speed_rad_s, high, high - 1, threshold_rad_s),
    )


def _crossing(
    grid_deg: Array, speed_rad_s: Array, moving: int, standing: int, threshold_rad_s: float
) -> float:
    """Phase at which the speed passes the threshold between two grid points."""
    fast, slow = abs(float(speed_rad_s[moving])), abs(float(speed_rad_s[standing]))
    share = (fast - threshold_rad_s) / (fast - slow)
    return float(grid_deg[moving] + share * (grid_deg[standing] - grid_deg[moving]))
