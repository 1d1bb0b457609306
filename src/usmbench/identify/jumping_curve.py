"""The curve of a motor that starts with a jump, where the samples bear it out."""

from collections.abc import Sequence

import numpy as np

from usmbench.identify.curve_rows import CurveRows, block_rows
from usmbench.identify.data import Dataset
from usmbench.identify.knots import dead_zone_deg
from usmbench.identify.projected import Projected
from usmbench.identify.selection import (
    Choice,
    better,
    choose_curve,
    fitted_curve,
    judge_knots,
)
from usmbench.identify.start_jump import LEAST_JUMP, StartJump, start_jumps
from usmbench.model.hammerstein import StaticCurve

_DEGREE = 24  # at least: knots at both edges leave few for the rest
_STIFF = (3e-2, 1e-2, 3e-3, 1e-3)  # the stiffest first
_NEAR = 0.03  # of the range: how far beyond a jump a curve has to rise
_CLOSEST, _WIDER = 2e-4, (1e-3, 2.5e-3, 5e-3)  # of the range: how closely knots gather


def jumping_choice(
    data: Dataset,
    point: int,
    rough: Projected,
    smooth: tuple[Choice, CurveRows],
    degrees: tuple[int, ...],
) -> tuple[Choice, CurveRows] | None:
    """Choose a curve with knots where the speed jumps, and say on which samples.

    Parameters
    ----------
    data
        The samples.
    point
        Index of the operating point.
    rough
        A first fit to the same samples.
    smooth
        The curve that bends, and the samples on which it was chosen.
    degrees
        Degrees that the samples can carry, rising.

    Returns
    -------
    tuple of Choice and CurveRows, or None
        None where no jump is found, or the curve that bends is as good.
    """
    span_deg = data.spans_deg[point]
    if not start_jumps(block_rows(data, point, rough), span_deg):
        return None
    rows = block_rows(data, point, rough, None)
    jumps = start_jumps(rows, span_deg)
    if not jumps:
        return None
    edges_deg = jump_edges_deg(jumps, fitted_curve(smooth[1], smooth[0]))
    high = tuple(d for d in degrees if d >= _DEGREE) or degrees[-1:]
    jumping = choose_curve(rows, high, (edges_deg,), span_deg, jump_widths(jumps, span_deg), _STIFF)
    worth = better(jumping, judge_knots(rows, smooth[0].knots_deg))
    return (jumping, rows) if worth and rises(fitted_curve(rows, jumping), edges_deg) else None


def rises(curve: StaticCurve, edges_deg: Sequence[float]) -> bool:
    """Return whether a curve does not fall back beyond the edges of its dead zone.

    Close knots between phases that were not driven leave a curve free to.

    Parameters
    ----------
    curve
        The curve.
    edges_deg
        The edges, rising; where there is one, the curve stands between it and 0.
    """
    low_deg, high_deg = curve.knots_deg[[0, -1]]
    top_rad_s = float(np.max(np.abs(curve.delta[[0, -1]])))
    ways = (-1.0, 1.0) if len(edges_deg) == 2 else np.sign(edges_deg)
    for edge_deg, way in zip(edges_deg, ways, strict=True):
        reach_deg = way * _NEAR * (high_deg - low_deg)
        beyond_deg = np.clip(edge_deg + np.linspace(0.0, reach_deg, 201), low_deg, high_deg)
        size = np.abs(curve.speed_rad_s(beyond_deg))
        if np.max(np.maximum.accumulate(size) - size) > LEAST_JUMP * top_rad_s:
            return False
    return True


def jump_edges_deg(jumps: Sequence[StartJump], curve: StaticCurve) -> tuple[float, ...]:
    """Return the edges of the dead zone: the jumps, and where a curve has them on other sides.

    Parameters
    ----------
    jumps
        The jumps.
    curve
        A curve that does not jump.
    """
    edges_deg = [edge_deg for edge_deg in dead_zone_deg(curve) if edge_deg is not None]
    for jump in jumps:
        if edges_deg:
            edges_deg.remove(min(edges_deg, key=lambda edge: abs(edge - jump.phase_deg)))
    return tuple(sorted([*edges_deg, *(jump.phase_deg for jump in jumps)]))


def jump_widths(jumps: Sequence[StartJump], span_deg: tuple[float, float]) -> tuple[float, ...]:
    """Return how closely knots may be gathered at jumps, of the range of phases.

    Parameters
    ----------
    jumps
        The jumps.
    span_deg
        Ends of the curve.
    """
    reach = max(jump.reach_deg for jump in jumps) / (span_deg[1] - span_deg[0])
    least = max(reach, _CLOSEST)
    return (least, *(width for width in _WIDER if width > least))
