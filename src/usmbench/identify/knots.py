"""Where the knots go: close together where the curve bends, at the edges of the dead zone."""

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import StaticCurve

Array = NDArray[np.float64]

_GRID = 2001
_AT_END = 0.02  # of the range: what bends there is its end
_SLOW, _FAST = 0.03, 0.12  # of the highest speed: where the tangents are taken
_AT_ONCE, _STEEPER = 0.01, 2.0  # of the highest speed, times: a curve so much steeper below jumps


def fine_grid_deg(low_deg: float, high_deg: float) -> Array:
    """Return even phases, close enough to see where a curve bends, shape (2001,).

    Parameters
    ----------
    low_deg, high_deg
        The ends.
    """
    return np.linspace(low_deg, high_deg, _GRID)


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
    grid_deg = fine_grid_deg(low_deg, high_deg)
    density = np.full(grid_deg.size, (1.0 - share) / (high_deg - low_deg))
    for edge_deg in np.clip(edges_deg, low_deg, high_deg):
        hump = np.exp(-0.5 * ((grid_deg - edge_deg) / width_deg) ** 2)
        density += share / len(edges_deg) * hump / np.trapezoid(hump, grid_deg)
    mass = np.r_[0.0, np.cumsum(0.5 * (density[1:] + density[:-1]))]
    knots_deg: Array = np.interp(np.linspace(0.0, mass[-1], degree + 1), mass, grid_deg)
    knots_deg[0], knots_deg[-1] = low_deg, high_deg
    return knots_deg


def dead_zone_deg(curve: StaticCurve) -> tuple[float | None, float | None]:
    """Return the edges of the dead zone: where the tangents beside it meet standstill.

    The tangents are chords between 3 % and 12 % of the highest speed, or between 1 % and 3 % where
    the curve is twice as steep there: of a motor that starts with a jump. A threshold of speed
    would put each edge too far out, by the threshold over the slope.

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
    grid_deg = fine_grid_deg(*curve.knots_deg[[0, -1]])
    edges = standing_edges_deg(grid_deg, curve.speed_rad_s(grid_deg)[None])[0]
    low, high = (None if np.isnan(edge) else edge for edge in edges.tolist())
    return low, high


def knees_deg(
    grid_deg: Array, speed_rad_s: Array, edges_deg: tuple[float, ...]
) -> tuple[float, ...]:
    """Return where a curve that saturates all at once would: where its steepest tangents end.

    Parameters
    ----------
    grid_deg, speed_rad_s
        The curve: rising phases and settled speeds, shape (N,) each.
    edges_deg
        Edges of its dead zone, of which each has a side that lies beyond.

    Returns
    -------
    tuple of float
        A phase for each edge beyond which the steepest tangent meets the highest speed of that
        side before the curve ends.
    """
    size = np.abs(speed_rad_s)
    margin_deg = _AT_END * float(grid_deg[-1] - grid_deg[0])
    knees = []
    for edge_deg in edges_deg:
        way = 1.0 if edge_deg == max(edges_deg) else -1.0
        beyond = np.flatnonzero(way * (grid_deg - edge_deg) > 0.0)
        if beyond.size < 2:
            continue
        slope = way * np.gradient(size[beyond], grid_deg[beyond])
        at = int(np.argmax(slope))
        if slope[at] <= 0.0:
            continue
        rest = float(np.max(size[beyond])) - float(size[beyond][at])
        knee_deg = float(grid_deg[beyond][at]) + way * rest / float(slope[at])
        if grid_deg[0] + margin_deg < knee_deg < grid_deg[-1] - margin_deg:
            knees.append(knee_deg)
    return tuple(knees)


def standing_edges_deg(grid_deg: Array, speeds_rad_s: Array) -> Array:
    """Return the edges of the dead zones of curves given on a grid, as `dead_zone_deg` does.

    Parameters
    ----------
    grid_deg
        Rising phases, shape (N,).
    speeds_rad_s
        Settled speeds of each curve there, shape (K, N).

    Returns
    -------
    Array
        Lower and upper edge, shape (K, 2); NaN where there is none.
    """
    size = np.abs(speeds_rad_s)
    top = size.max(axis=1, keepdims=True)
    away_deg = np.where(size <= _SLOW * top, np.abs(grid_deg), np.inf)
    centre = np.argmin(away_deg, axis=1)
    edges = np.column_stack(
        [
            _tangent_feet_deg(size[:, ::-1], grid_deg[::-1], grid_deg.size - 1 - centre),
            _tangent_feet_deg(size, grid_deg, centre),
        ]
    )
    edges[np.isinf(away_deg.min(axis=1))] = np.nan
    crossed = edges[:, 0] > edges[:, 1]
    edges[crossed] = edges[crossed].mean(axis=1, keepdims=True)
    return edges


def _tangent_feet_deg(size: Array, phase_deg: Array, centre: NDArray[np.intp]) -> Array:
    """Phases beyond the centres at which the chord between two speeds, continued, meets zero."""
    top, beyond = size.max(axis=1), np.arange(phase_deg.size) > centre[:, None]
    least_deg, slow_deg, fast_deg = (
        _first_crossings_deg(size, phase_deg, level * top, beyond)
        for level in (_AT_ONCE, _SLOW, _FAST)
    )
    at_once = (slow_deg - least_deg) / (_SLOW - _AT_ONCE)
    later = (fast_deg - slow_deg) / (_FAST - _SLOW)
    jumps = _STEEPER * np.abs(at_once) < np.abs(later)
    return np.where(jumps, least_deg - _AT_ONCE * at_once, slow_deg - _SLOW * later)


def _first_crossings_deg(
    size: Array, phase_deg: Array, level: Array, beyond: NDArray[np.bool_]
) -> Array:
    """Phases at which a speed is first reached, between the grid's points; NaN where never."""
    reached = beyond & (size > level[:, None])
    after = np.maximum(np.argmax(reached, axis=1), 1)
    curves = np.arange(after.size)
    slower, faster = size[curves, after - 1], size[curves, after]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (level - slower) / (faster - slower)
    crossing_deg = phase_deg[after - 1] + share * (phase_deg[after] - phase_deg[after - 1])
    return np.where(reached.any(axis=1), crossing_deg, np.nan)
