"""Where a curve was not measured: between phases, beyond a drive's last but one, at its ends."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.dead_zone import STANDING

Array = NDArray[np.float64]

_ALONE = 4.0  # usual gaps between phases that set an end apart
_SAME = 2e-5  # of the range, for a node to lie at a measured phase
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


def unmeasured_rad_s(
    nodes_deg: Sequence[float], measured_deg: Array, phase_deg: Array, speeds_rad_s: Sequence[Array]
) -> tuple[float, ...]:
    """Return how far off a curve may be at its nodes for lying between measured phases.

    Over a gap of width h in which the slope turns by s, a curve may turn anywhere: a straight line
    across is off by up to s h / 4.

    Parameters
    ----------
    nodes_deg
        The nodes.
    measured_deg
        Phases that were measured, rising, shape (M,).
    phase_deg
        Phases, evenly spaced and rising, shape (N,).
    speeds_rad_s
        Settled speeds there at each operating point, shape (N,) each.
    """
    if measured_deg.size < 2:
        return (0.0,) * len(nodes_deg)
    nodes, same_deg = np.array(nodes_deg), _SAME * (phase_deg[-1] - phase_deg[0])
    right = np.clip(np.searchsorted(measured_deg, nodes), 1, measured_deg.size - 1)
    apart_deg = np.minimum(nodes - measured_deg[right - 1], measured_deg[right] - nodes)
    turn = np.zeros(nodes.size)
    for speed_rad_s in speeds_rad_s:
        slope = np.gradient(speed_rad_s, phase_deg)
        at_rad_s = np.interp(measured_deg, phase_deg, speed_rad_s)
        for n in np.flatnonzero(apart_deg > same_deg):
            inside = _inside(slope, phase_deg, measured_deg[right[n] - 1 : right[n] + 1])
            turn[n] = max(turn[n], inside, _at_edge(at_rad_s, measured_deg, int(right[n])))
    off_rad_s = 0.25 * turn * (measured_deg[right] - measured_deg[right - 1])
    return tuple(float(f"{off:.4g}") for off in off_rad_s)


def _inside(slope: Array, phase_deg: Array, ends_deg: Array) -> float:
    """By how much a slope turns between two phases."""
    near = (phase_deg >= ends_deg[0]) & (phase_deg <= ends_deg[1])
    return float(np.ptp(slope[near])) if near.any() else 0.0


def _at_edge(at_rad_s: Array, measured_deg: Array, right: int) -> float:
    """By how much a slope may turn where the dead zone ends between two measured phases, or at one.

    Where in the gap it ends the model cannot know; the slopes beside it say how steeply a rotor
    starts.
    """
    stands = np.abs(at_rad_s[right - 1 : right + 1]) < STANDING * np.max(np.abs(at_rad_s))
    if stands.all() or not stands.any():
        return 0.0
    near = slice(max(right - 2, 0), right + 2)
    return float(np.ptp(np.diff(at_rad_s[near]) / np.diff(measured_deg[near])))


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
