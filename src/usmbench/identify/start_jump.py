"""Where a motor starts with a jump: friction that holds lets go at a speed that is not 0.

A curve of knots that are not gathered there, to within a fraction of a degree, smooths the jump
over degrees; and tangents put the edge of the dead zone where the speed beyond it would begin.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.bends import NODES, polygon_rows, responses
from usmbench.identify.curve_rows import CurveRows
from usmbench.identify.robust import OVER_MEDIAN

Array = NDArray[np.float64]

_STANDING, _FAR = 0.03, 0.3  # of the highest speed: from where to where a jump is looked for
_PLACES, _ROUNDS, _REACH = 33, 3, 2  # compared at once; how often; steps beside the best one
_SURE = 8.0  # standard deviations of a jump's height
_ANY = 0.25  # of the fall that makes sure: less shows even beside a jump between two places
_AS_GOOD = 3.0  # standard deviations by which a place is better that is no likelier
LEAST_JUMP = 0.02  # of the highest speed: less is a bend
_BESIDE = 0.35  # of the way between two nodes
_NOTHING, _TINY = 0.02, 1e-300  # of a column's square; what is no divisor


@dataclass(frozen=True, slots=True)
class StartJump:
    """A phase at which the settled speed jumps from standstill.

    Parameters
    ----------
    phase_deg
        The phase.
    reach_deg
        How far from it the jump may as well be.
    """

    phase_deg: float
    reach_deg: float


@dataclass(frozen=True, slots=True)
class _Beside:
    """What a polygon leaves of samples, and how much better it gets by a bend or a jump."""

    rows: CurveRows
    nodes_deg: Array
    span: Array  # orthonormal columns that the polygon spans
    left: Array

    @property
    def variance(self) -> float:
        """Variance of what is left, by its median: samples about a jump are few and far off."""
        own = self.left[: sum(np.count_nonzero(fold >= -1) for fold in self.rows.fold)]
        return float(OVER_MEDIAN * np.median(np.abs(own))) ** 2

    def tried(self, places_deg: Array, way: int) -> Array:
        """Return places, falls of the squares by a bend, by bend and jump, and a jump's height."""
        columns = responses(self.rows, lambda phase_deg: self._off(phase_deg, places_deg, way))
        columns = np.vstack([columns, np.zeros((self.left.size - len(columns), columns.shape[1]))])
        bend, jump = np.hsplit(columns - self.span @ (self.span.T @ columns), 2)
        of_bend, _ = _fall(bend, self.left)
        _, height = _fall(jump, self.left)
        least = _NOTHING * np.sum(jump**2, axis=0)
        jump -= bend * (np.sum(bend * jump, axis=0) / np.maximum(np.sum(bend**2, axis=0), _TINY))
        jump[:, np.sum(jump**2, axis=0) <= least] = 0.0
        both = of_bend + _fall(jump, self.left)[0]
        # Beside a node the polygon bends by itself; two bends so close would be a jump.
        apart_deg = np.min(np.abs(places_deg - self.nodes_deg[:, None]), axis=0)
        of_bend[apart_deg < _BESIDE * (self.nodes_deg[1] - self.nodes_deg[0])] = 0.0
        return np.stack([places_deg, of_bend, both, height])

    def _off(self, phase_deg: Array, places_deg: Array, way: int) -> Array:
        """Slopes and steps from places on, less what the polygon makes of them."""
        at_nodes = _shapes(self.nodes_deg, places_deg, way)
        left = np.clip(np.searchsorted(self.nodes_deg, phase_deg) - 1, 0, NODES - 2)
        width_deg = self.nodes_deg[left + 1] - self.nodes_deg[left]
        share = ((phase_deg - self.nodes_deg[left]) / width_deg)[:, None]
        chord = (1.0 - share) * at_nodes[left] + share * at_nodes[left + 1]
        return _shapes(phase_deg, places_deg, way) - chord


def start_jumps(rows: CurveRows, span_deg: tuple[float, float]) -> tuple[StartJump, ...]:
    """Return where the speed jumps from standstill, at most once on each side of 0.

    A polygon, with a bend wherever it helps most, is compared with one that jumps as well.

    Parameters
    ----------
    rows
        The samples.
    span_deg
        Ends of the curve.
    """
    nodes_deg = np.linspace(*span_deg, NODES)
    matrix, wanted = polygon_rows(rows, nodes_deg)
    span, corner = np.linalg.qr(matrix)
    speed_rad_s = np.linalg.lstsq(corner, span.T @ wanted, rcond=None)[0]
    beside = _Beside(rows, nodes_deg, span, wanted - span @ (span.T @ wanted))
    size = np.abs(speed_rad_s)
    still = size <= _STANDING * size.max()
    centre = int(np.argmin(np.where(still, np.abs(nodes_deg), np.inf)))
    if not (still[centre] and 0 < centre < NODES - 1):
        return ()
    found = [_jump(beside, nodes_deg, size, centre, way) for way in (-1, 1)]
    return tuple(jump for jump in found if jump is not None)


def _jump(
    beside: _Beside, nodes_deg: Array, size: Array, centre: int, way: int
) -> StartJump | None:
    """Return the jump on one side of a node that stands, where there is one."""
    outward = slice(centre, None) if way > 0 else slice(centre, None, -1)
    fast = size[outward] > _FAR * size.max()
    if not np.any(fast):
        return None
    low_deg, high_deg = sorted([nodes_deg[centre], nodes_deg[outward][np.argmax(fast)]])
    sure = _SURE**2 * beside.variance
    tried = np.empty((4, 0))  # as `_Beside.tried` returns them
    for _ in range(_ROUNDS):
        tried = np.hstack([tried, beside.tried(np.linspace(low_deg, high_deg, _PLACES), way)])
        best = int(np.argmax(tried[2]))
        if tried[2, best] < _ANY * sure:
            return None
        reach_deg = _REACH * (high_deg - low_deg) / (_PLACES - 1)
        low_deg, high_deg = tried[0, best] - reach_deg, tried[0, best] + reach_deg
    if tried[2, best] - tried[1].max() < sure or way * tried[3, best] < LEAST_JUMP * size.max():
        return None
    as_good_deg = tried[0, tried[2] >= tried[2, best] - _AS_GOOD**2 * beside.variance]
    low_deg, high_deg = float(as_good_deg.min()), float(as_good_deg.max())
    return StartJump(0.5 * (low_deg + high_deg), 0.5 * (high_deg - low_deg))


def _shapes(phase_deg: Array, places_deg: Array, way: int) -> Array:
    """Return a slope from each place on, then a step at each, shape (N, 2 K)."""
    far = way * (phase_deg[:, None] - places_deg)
    return np.hstack([np.maximum(far, 0.0), (far > 0.0).astype(np.float64)])


def _fall(columns: Array, left: Array) -> tuple[Array, Array]:
    """Fall of the squares by each column, and how much of it is taken."""
    squares = np.maximum(np.sum(columns**2, axis=0), _TINY)
    share = (left @ columns) / squares
    return share**2 * squares, share
