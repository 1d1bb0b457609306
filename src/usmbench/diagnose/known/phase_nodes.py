"""Nodes along the phase, between which what a curve may be off by is a straight line."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PHASE_NODES = 73
TABLED = 2001  # phases at which curves are asked, to lay out the nodes
_EVENLY = 2.0  # shares of four that lie evenly: between knots a curve waves where it is flat, too
_APART = 2e-5  # of the range: seven digits tell it


def phase_nodes(
    phase_deg: Array,
    speeds_rad_s: Sequence[Array],
    measured_deg: Sequence[float] | Array = (),
    also_deg: Sequence[float] = (),
) -> tuple[float, ...]:
    """Return nodes that share out the phases, the changes of speed, and the bends.

    Where a phase was measured near one, the node lies there: else what is seen beside it would say,
    along a straight line, what the curve is at a node that no run has come near.

    Parameters
    ----------
    phase_deg
        Phases, evenly spaced and rising, shape (N,).
    speeds_rad_s
        Settled speeds there at each operating point, shape (N,) each.
    measured_deg
        Phases that were measured, rising, shape (M,).
    also_deg
        Phases that have to be among them.
    """
    path = np.cumsum(sum(np.abs(np.diff(s, prepend=s[:1])) for s in speeds_rad_s))
    bend = np.cumsum(sum(np.abs(np.gradient(np.gradient(s))) for s in speeds_rad_s))
    along = np.linspace(0.0, _EVENLY, phase_deg.size)
    for part in (path, bend):
        along = along + part / max(float(part[-1]), 1e-12)
    shared = np.linspace(0.0, along[-1], PHASE_NODES - len(also_deg))
    nodes = np.sort(np.r_[np.interp(shared, along, phase_deg), also_deg])
    nodes = _at_measured(nodes, np.asarray(measured_deg))
    # Where a curve does all at one place, nodes would meet there.
    apart = _APART * (phase_deg[-1] - phase_deg[0]) * np.arange(PHASE_NODES)
    nodes = np.maximum.accumulate(nodes - apart) + apart
    nodes = np.minimum(nodes, phase_deg[-1] - apart[::-1])
    return tuple(float(f"{node:.7g}") for node in nodes)


def _at_measured(nodes_deg: Array, measured_deg: Array) -> Array:
    """Move each node to the nearest measured phase, where that has no nearer node."""
    if measured_deg.size == 0:
        return nodes_deg
    nearest_deg = measured_deg[_nearest(measured_deg, nodes_deg)]
    own = _nearest(nodes_deg, nearest_deg) == np.arange(nodes_deg.size)
    return np.where(own, nearest_deg, nodes_deg)


def _nearest(rising: Array, to: Array) -> NDArray[np.intp]:
    """Return which of rising values lies nearest to each of others."""
    return np.searchsorted(0.5 * (rising[1:] + rising[:-1]), to)
