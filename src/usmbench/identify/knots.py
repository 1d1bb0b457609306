"""Where the knots go: close together where the curve bends, at the edges of the dead zone."""

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import StaticCurve

Array = NDArray[np.float64]

_GRID = 4001
_SLOW, _FAST = 0.03, 0.12  # of the highest speed: where the tangents are taken


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


def dead_zone_deg(curve: StaticCurve) -> tuple[float | None, float | None]:
    """Return the edges of the dead zone: where the tangents beside it meet standstill.

    The tangents are chords between 3 % and 12 % of the highest speed. A threshold of speed would
    put each edge too far out, by the threshold over the slope.

    Parameters
    ----------
    curve
        The settled speed.

    Returns
    -------
    low, high
        Edges below and above the standing phase nearest to 0; None where the curve never stands,
        or ends before it has left standstill on that side.
    """
    grid_deg = np.linspace(curve.knots_deg[0], curve.knots_deg[-1], _GRID)
    return standing_edges_deg(grid_deg, curve.speed_rad_s(grid_deg))


def standing_edges_deg(grid_deg: Array, speed_rad_s: Array) -> tuple[float | None, float | None]:
    """Return the edges of the dead zone of a curve given on a grid, as `dead_zone_deg` does.

    Parameters
    ----------
    grid_deg
        Rising phases, shape (N,).
    speed_rad_s
        Settled speeds there, shape (N,).
    """
    size = np.abs(speed_rad_s)
    slow, fast = _SLOW * size.max(), _FAST * size.max()
    standing = np.flatnonzero(size <= slow)
    if standing.size == 0:
        return None, None
    centre = int(standing[np.argmin(np.abs(grid_deg[standing]))])
    low = _tangent_foot_deg(size[centre::-1], grid_deg[centre::-1], slow, fast)
    high = _tangent_foot_deg(size[centre:], grid_deg[centre:], slow, fast)
    if low is not None and high is not None and low > high:
        low = high = 0.5 * (low + high)
    return low, high


def _tangent_foot_deg(size: Array, phase_deg: Array, slow: float, fast: float) -> float | None:
    """Phase at which the chord between two speeds, continued, meets zero."""
    if size.max() <= fast:
        return None
    slow_deg, fast_deg = (_first_crossing_deg(size, phase_deg, level) for level in (slow, fast))
    return float(slow_deg - slow * (fast_deg - slow_deg) / (fast - slow))


def _first_crossing_deg(size: Array, phase_deg: Array, level: float) -> float:
    """Phase at which a speed is first reached, between the grid's points."""
    after = max(int(np.argmax(size > level)), 1)
    share = (level - size[after - 1]) / (size[after] - size[after - 1])
    return float(phase_deg[after - 1] + share * (phase_deg[after] - phase_deg[after - 1]))
