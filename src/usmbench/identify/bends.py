"""Where a curve bends: told by a polygon, which may turn at once anywhere.

A smooth curve of even knots rings where the motor's turns sharply, and has its dead zone somewhere
else or nowhere.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.curve_rows import CurveRows
from usmbench.identify.knots import fine_grid_deg, knees_deg, standing_edges_deg
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.polygon import hats, turns

Array = NDArray[np.float64]
Bends = tuple[tuple[float, ...], ...]
"""Sets of phases at which a curve may bend sharply."""

NODES = 61
_FEWEST_PHASES = 3
_STIFFNESS = 0.03  # of the polygon: nodes follow their rows, those that have none their neighbours
_SAME = 0.005  # of the range of phases


def bends_of_rows(rows: CurveRows, span_deg: tuple[float, float]) -> Bends:
    """Return where a polygon fitted to samples bends.

    Parameters
    ----------
    rows
        The samples.
    span_deg
        Ends of the curve.
    """
    phases_deg = np.unique(np.concatenate(rows.phase_deg))
    if phases_deg.size < _FEWEST_PHASES:
        return ()
    nodes_deg = phases_deg if phases_deg.size <= NODES else np.linspace(*span_deg, NODES)
    speed_rad_s = np.linalg.lstsq(*polygon_rows(rows, nodes_deg), rcond=None)[0]
    grid_deg = fine_grid_deg(*span_deg)
    return _bends(grid_deg, np.interp(grid_deg, nodes_deg, speed_rad_s))


def bends_of_curve(curve: StaticCurve) -> Bends:
    """Return where a curve bends.

    Parameters
    ----------
    curve
        The curve.
    """
    grid_deg = fine_grid_deg(*curve.knots_deg[[0, -1]])
    return _bends(grid_deg, curve.speed_rad_s(grid_deg))


def joined(some: Bends, others: Bends, span_deg: tuple[float, float]) -> Bends:
    """Return both, without those of the others that are at the same places.

    Parameters
    ----------
    some, others
        The bends.
    span_deg
        Ends of the curve.
    """
    new = [bends for bends in others if not any(_same(bends, own, span_deg) for own in some)]
    return (*some, *new)


def _bends(grid_deg: Array, speed_rad_s: Array) -> Bends:
    """Edges of the dead zone, as far as there is any, and these with where the speed saturates."""
    edges = standing_edges_deg(grid_deg, speed_rad_s[None])[0]
    edges_deg = tuple(edges[~np.isnan(edges)].tolist())
    knees = knees_deg(grid_deg, speed_rad_s, edges_deg)
    return tuple(bends for bends in (edges_deg, edges_deg + knees if knees else ()) if bends)


def _same(
    one_deg: Sequence[float], other_deg: Sequence[float], span_deg: tuple[float, float]
) -> bool:
    """Whether knots would be gathered at the same places."""
    close_deg = _SAME * (span_deg[1] - span_deg[0])
    return len(one_deg) == len(other_deg) and np.allclose(
        one_deg, other_deg, rtol=0.0, atol=close_deg
    )


def polygon_rows(rows: CurveRows, nodes_deg: Array) -> tuple[Array, Array]:
    """Return the least-squares problem of a polygon, each sample over its spread.

    Parameters
    ----------
    rows
        The samples, of which those that are used count.
    nodes_deg
        The polygon's nodes, shape (K,).

    Returns
    -------
    matrix, wanted
        Shape (N + K − 2, K) and (N + K − 2,): the samples, then what holds nodes without any.
    """
    shapes = responses(rows, lambda phase_deg: np.column_stack(list(hats(phase_deg, nodes_deg))))
    used = np.concatenate(rows.fold) >= -1
    wanted = (np.concatenate(rows.speed_rad_s) * np.concatenate(rows.weight))[used]
    share, width_deg = np.sqrt(wanted.size / nodes_deg.size), float(np.mean(np.diff(nodes_deg)))
    pull = _STIFFNESS * share * width_deg * turns(nodes_deg)
    return np.vstack([shapes, pull]), np.r_[wanted, np.zeros(len(pull))]


def responses(rows: CurveRows, shapes: Callable[[Array], Array]) -> Array:
    """Return what shapes of a curve do to the samples that are used, each over its spread.

    Parameters
    ----------
    rows
        The samples.
    shapes
        From phases, shape (M,), to the shapes' values there, shape (M, K).

    Returns
    -------
    Array
        Shape (N, K).
    """
    felt = np.vstack([rows.dynamics.respond(shapes(phase_deg)) for phase_deg in rows.phase_deg])
    used = np.concatenate(rows.fold) >= -1
    return np.asarray((felt * np.concatenate(rows.weight)[:, None])[used])
