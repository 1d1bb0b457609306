"""Where a motor starts with a jump: friction that holds lets go at a speed that is not 0.

A curve of knots that are not gathered there, to within a fraction of a degree, smooths the jump
over degrees; and tangents put the edge of the dead zone where the speed beyond it would begin.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.bends import NODES, polygon_rows, responses
from usmbench.identify.curve_rows import CurveRows
from usmbench.identify.robust_fit import OVER_MEDIAN

Array = NDArray[np.float64]

_STANDING, _FAR = 0.03, 0.3  # of the highest speed: from where to where a jump is looked for
_PLACES, _REACH = 32, 2  # compared at once; steps beside the best one
_SURE = 5.0  # standard deviations of a jump's height
_AS_WELL = 3.0  # of the other one's: friction that holds one way holds the other
_ANY = 0.25  # of the fall that makes sure: less shows even beside a jump between two places
_AS_GOOD = 3.0  # standard deviations by which a place is better that is no likelier
_PLACED = 0.01  # of the range: a jump that may as well be further away is a bend
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
    height_rad_s
        About how high it is.
    """

    phase_deg: float
    reach_deg: float
    height_rad_s: float


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

    def with_jump(self, place_deg: float, way: int) -> "_Beside":
        """Return what is left beside a polygon that bends and jumps at a place as well."""
        more, _ = np.linalg.qr(self._columns(np.array([place_deg]), way))
        left = self.left - more @ (more.T @ self.left)
        return _Beside(self.rows, self.nodes_deg, np.hstack([self.span, more]), left)

    def tried(self, places_deg: Array, way: int) -> Array:
        """Return places, falls of the squares by a bend, by bend and jump, and a jump's height."""
        bend, jump = np.hsplit(self._columns(places_deg, way), 2)
        of_bend, _ = _fall(bend, self.left)
        of_jump, alone = _fall(jump, self.left)
        least = _NOTHING * np.sum(jump**2, axis=0)
        jump -= bend * (np.sum(bend * jump, axis=0) / np.maximum(np.sum(bend**2, axis=0), _TINY))
        more, height = _fall(jump, self.left)
        alike = np.sum(jump**2, axis=0) <= least
        both = np.where(alike, np.maximum(of_bend, of_jump), of_bend + more)
        height = np.where(alike, alone, height)
        # Beside a node the polygon bends by itself; two bends so close would be a jump.
        apart_deg = np.min(np.abs(places_deg - self.nodes_deg[:, None]), axis=0)
        of_bend[apart_deg < _BESIDE * (self.nodes_deg[1] - self.nodes_deg[0])] = 0.0
        return np.stack([places_deg, of_bend, both, height])

    def _columns(self, places_deg: Array, way: int) -> Array:
        """Return what slopes and steps from places on do that nothing in the span does."""
        columns = responses(self.rows, lambda phase_deg: _shapes(phase_deg, places_deg, way))
        columns = np.vstack([columns, np.zeros((self.left.size - len(columns), columns.shape[1]))])
        return np.asarray(columns - self.span @ (self.span.T @ columns))


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
    found: dict[int, StartJump] = {}
    while jumps := {
        way: jump
        for way in {-1, 1}.difference(found)
        if (jump := _jump(beside, size, centre, way, _AS_WELL if found else _SURE)) is not None
    }:
        # The larger one first: it reaches over to the other side by what a polygon makes of it.
        way = max(jumps, key=lambda way: jumps[way].height_rad_s)
        found[way], beside = jumps[way], beside.with_jump(jumps[way].phase_deg, way)
    return tuple(found[way] for way in sorted(found))


def _jump(beside: _Beside, size: Array, centre: int, way: int, sure: float) -> StartJump | None:
    """Return the jump on one side of a node that stands, where there surely is one."""
    outward = slice(centre, None) if way > 0 else slice(centre, None, -1)
    fast = size[outward] > _FAR * size.max()
    if not np.any(fast):
        return None
    nodes_deg = beside.nodes_deg
    ends_deg = np.sort([nodes_deg[centre], nodes_deg[outward][np.argmax(fast)]])
    driven_deg = np.unique(np.concatenate(beside.rows.phase_deg))
    driven_deg = driven_deg[slice(*np.searchsorted(driven_deg, ends_deg))]
    least = sure**2 * beside.variance
    tried = _tried_between(beside, driven_deg, way, _ANY * least)
    if tried is None:
        return None
    best = int(np.argmax(tried[2]))
    height_rad_s = float(way * tried[3, best])
    if tried[2, best] - tried[1].max() < least or height_rad_s < LEAST_JUMP * size.max():
        return None
    as_good_deg = tried[0, tried[2] >= tried[2, best] - _AS_GOOD**2 * beside.variance]
    first, last = np.searchsorted(driven_deg, [as_good_deg.min(), as_good_deg.max()])
    low_deg, high_deg = float(driven_deg[first - 1]), float(driven_deg[last])
    if high_deg - low_deg > 2.0 * _PLACED * (nodes_deg[-1] - nodes_deg[0]):
        return None
    return StartJump(0.5 * (low_deg + high_deg), 0.5 * (high_deg - low_deg), height_rad_s)


def _tried_between(beside: _Beside, driven_deg: Array, way: int, least: float) -> Array | None:
    """Try places between driven phases: there is nothing to tell those between the same two.

    Returns what `_Beside.tried` does, down to single phases about the best place; or None where
    none is better by more than the least fall.
    """
    between_deg = 0.5 * (driven_deg[1:] + driven_deg[:-1])
    tried = np.empty((4, 0))
    first, last = 0, between_deg.size - 1
    while first <= last:
        step = max(-(-(last - first) // _PLACES), 1)
        asked = np.arange(first, last + 1, step)
        tried = np.hstack([tried, beside.tried(between_deg[asked], way)])
        best = int(np.argmax(tried[2]))
        if tried[2, best] < least:
            return None
        if step == 1:
            return tried
        at = int(np.searchsorted(between_deg, tried[0, best]))
        first, last = max(at - _REACH * step, 0), min(at + _REACH * step, between_deg.size - 1)
    return None


def _shapes(phase_deg: Array, places_deg: Array, way: int) -> Array:
    """Return a slope from each place on, then a step at each, shape (N, 2 K)."""
    far = way * (phase_deg[:, None] - places_deg)
    return np.hstack([np.maximum(far, 0.0), (far > 0.0).astype(np.float64)])


def _fall(columns: Array, left: Array) -> tuple[Array, Array]:
    """Fall of the squares by each column, and how much of it is taken."""
    squares = np.maximum(np.sum(columns**2, axis=0), _TINY)
    share = (left @ columns) / squares
    return share**2 * squares, share
