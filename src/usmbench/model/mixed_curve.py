"""What is known at some operating points, row by row between them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import OperatingPoint

Array = NDArray[np.float64]

_MARGIN = 0.01  # of a point's range of phases


@dataclass(frozen=True, slots=True)
class Mixed:
    """What hangs on the phase, another at each operating point, mixed row by row.

    Parameters
    ----------
    curves
        One a point: phases in, values out.
    weights
        Weight of each point on each row, shape (N,) each.
    """

    curves: tuple[Callable[[Array], Array], ...]
    weights: tuple[Array, ...]

    def __call__(self, phase_deg: Array) -> Array:
        """Return the value on each row.

        Parameters
        ----------
        phase_deg
            Phase of each row, shape (N,).
        """
        mixed = np.zeros(phase_deg.size)
        for curve, weight in zip(self.curves, self.weights, strict=True):
            rows = weight != 0.0
            if np.any(rows):
                mixed[rows] += weight[rows] * curve(phase_deg[rows])
        return mixed


def settled_speed(points: Sequence[OperatingPoint], weights: Sequence[Array]) -> Mixed:
    """Return the static curve row by row.

    Parameters
    ----------
    points
        The model's operating points.
    weights
        As `point_weights` returns them.
    """
    return Mixed(tuple(point.curve.speed_rad_s for point in points), tuple(weights))


def beyond_range(
    points: Sequence[OperatingPoint], weights: Sequence[Array], phase_deg: Array
) -> NDArray[np.bool_]:
    """Return the rows whose phase lies beyond the range of a point that counts there, shape (N,).

    A hundredth of the range is within it: phases that were drawn seldom reach its very ends.

    Parameters
    ----------
    points
        The model's operating points.
    weights
        As `point_weights` returns them.
    phase_deg
        Phase of each row, shape (N,).
    """
    beyond = np.zeros(phase_deg.size, dtype=np.bool_)
    for point, weight in zip(points, weights, strict=True):
        low_deg, high_deg = point.phase_range_deg
        more_deg = _MARGIN * (high_deg - low_deg)
        far = (phase_deg < low_deg - more_deg) | (phase_deg > high_deg + more_deg)
        beyond |= (weight != 0.0) & far
    return beyond
