"""How the settled speed changes along the resonance, from curves at neighbouring frequencies.

The error of a curve is small beside the speed, not so beside what 25 Hz change: at the ends, where
few phases were measured, and at the corner of the dead zone, which a curve rounds off. But at one
frequency the speed tells how far the wave travels as well as the phase does, so on either side the
change is a smooth function of the speed, of which all phases tell.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import OperatingPoint
from usmbench.model.mixed_curve import Mixed
from usmbench.model.operating_points import slope_table

Array = NDArray[np.float64]

_STEP_DEG = 1.0
_RUNS, _RUNS_WELL = 0.01, 0.08  # shares of the point's highest speed
_DEGREE, _FEWEST = 2, 9  # of the polynomial, phases that it takes
_LITTLE = 0.1  # of the highest speed: over so little, the resonance curve is straight


@dataclass(frozen=True, slots=True)
class PointSlope:
    """f ∂v/∂f at an operating point.

    Parameters
    ----------
    point
        The point.
    others
        The points whose curves it is the difference of, and how much each counts.
    top_rad_s
        Highest speed of the point.
    polynomials
        What it is over the speed's share of the highest, from the constant on, at negative and at
        positive phases, shape (3,) each; None where too few phases tell.
    """

    point: OperatingPoint
    others: tuple[tuple[OperatingPoint, float], ...]
    top_rad_s: float = 0.0
    polynomials: tuple[Array | None, Array | None] = (None, None)

    def rad_s(self, phase_deg: Array) -> Array:
        """Return the change of the settled speed with the relative frequency, shape (N,).

        Parameters
        ----------
        phase_deg
            Phases, shape (N,).
        """
        slope = self.difference_rad_s(phase_deg)
        share = np.abs(self.point.curve.speed_rad_s(phase_deg)) / max(self.top_rad_s, 1e-12)
        for way, polynomial in zip((-1.0, 1.0), self.polynomials, strict=True):
            if polynomial is not None:
                rows = (np.sign(phase_deg) == way) & (share > _RUNS)
                slope[rows] = np.polynomial.polynomial.polyval(share[rows], polynomial)
        return slope

    def difference_rad_s(self, phase_deg: Array) -> Array:
        """Return the same as the plain difference of the curves, shape (N,).

        Parameters
        ----------
        phase_deg
            Phases, shape (N,).
        """
        slope = np.zeros(phase_deg.size)
        for other, weight in self.others:
            slope += weight * other.curve.speed_rad_s(phase_deg)
        return slope


def point_slopes(points: Sequence[OperatingPoint]) -> tuple[PointSlope, ...] | None:
    """Return the slope along the resonance at every operating point.

    Parameters
    ----------
    points
        The model's operating points.

    Returns
    -------
    tuple of PointSlope or None
        None where a point has no neighbour in frequency at its torque.
    """
    table = slope_table(points)
    if table is None:
        return None
    return tuple(_fitted(points, i, _central(points, table, i)) for i in range(len(points)))


def mixed_slope(slopes: Sequence[PointSlope] | None, weights: Sequence[Array]) -> Mixed | None:
    """Return f ∂v/∂f row by row.

    Parameters
    ----------
    slopes
        As `point_slopes` returns them; None gives None.
    weights
        Weight of each point on each row, shape (N,) each.
    """
    if slopes is None:
        return None
    return Mixed(tuple(slope.rad_s for slope in slopes), tuple(weights))


def _central(points: Sequence[OperatingPoint], table: Array, i: int) -> list[float]:
    """Weights of the curves: at an end, those of its neighbour, if the curve is straight so far.

    From one side only, a parabola makes four times as much of the curves' errors.
    """
    sides, nearest = _sides(points, table, i)
    if len(sides) == 1 and nearest is not None and len(_sides(points, table, nearest)[0]) == 2:
        here, there = points[i], points[nearest]
        low_deg = max(here.phase_range_deg[0], there.phase_range_deg[0])
        high_deg = min(here.phase_range_deg[1], there.phase_range_deg[1])
        phase_deg = np.arange(low_deg, high_deg, _STEP_DEG)
        speed, other = (p.curve.speed_rad_s(phase_deg) for p in (here, there))
        highest = np.max(np.abs(speed), initial=0.0)
        if np.max(np.abs(speed - other), initial=0.0) <= _LITTLE * highest:
            return list(table[nearest])
    return list(table[i])


def _sides(points: Sequence[OperatingPoint], table: Array, i: int) -> tuple[set[float], int | None]:
    """On which sides in frequency the neighbours of a point lie, and the nearest of two."""
    steps_hz = {
        k: (points[k].frequency_hz or 0.0) - (points[i].frequency_hz or 0.0)
        for k in np.flatnonzero(table[i]).tolist()
        if k != i
    }
    nearest = min(steps_hz, key=lambda k: abs(steps_hz[k])) if len(steps_hz) == 2 else None
    return {float(np.sign(step)) for step in steps_hz.values()}, nearest


def _fitted(points: Sequence[OperatingPoint], i: int, row: Sequence[float]) -> PointSlope:
    others = tuple((p, float(w)) for p, w in zip(points, row, strict=True) if w != 0.0)
    plain = PointSlope(points[i], others)
    reach_deg = (
        max(other.phase_range_deg[0] for other, _ in others),
        min(other.phase_range_deg[1] for other, _ in others),
    )
    sides = [
        np.arange(way * _STEP_DEG, end, way * _STEP_DEG)
        for way, end in zip((-1.0, 1.0), reach_deg, strict=True)
    ]
    speeds = [np.abs(points[i].curve.speed_rad_s(side)) for side in sides]
    top_rad_s = max(float(np.max(speed, initial=0.0)) for speed in speeds)
    negative, positive = (
        _polynomial(speed / max(top_rad_s, 1e-12), plain.difference_rad_s(side))
        for speed, side in zip(speeds, sides, strict=True)
    )
    return PointSlope(points[i], others, top_rad_s, (negative, positive))


def _polynomial(share: Array, slope_rad_s: Array) -> Array | None:
    """Fit a slope over the speed, where the rotor turns well."""
    well = share > _RUNS_WELL
    if np.count_nonzero(well) < _FEWEST:
        return None
    return np.asarray(np.polynomial.polynomial.polyfit(share[well], slope_rad_s[well], _DEGREE))
