"""An output-error problem near its estimate: what intervals and tests of the residual rest on."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.row_weights import RowWeights, of_unit_length, times, without
from usmbench.identify.triangle import triangle

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Linearised:
    """One stretch near the estimate, each row over its spread.

    Parameters
    ----------
    regressors
        Curve's ordinates, then the dynamics' parameters, shape (n, d + 1 + q).
    influence
        Bisquare influence ``u (1 − u²)²`` of each residual, shape (n,).
    slope
        Slope ``(1 − u²) (1 − 5 u²)`` of that influence, shape (n,).
    settled_rad_s
        The static curve's output, shape (n,).
    point
        Index of the operating point.
    """

    regressors: Array
    influence: Array
    slope: Array
    settled_rad_s: Array
    point: int

    @classmethod
    def of(
        cls,
        columns: Array,
        fading_shape: Array,
        weights: RowWeights,
        residual_rad_s: Array,
        settled_rad_s: Array,
        point: int,
    ) -> "Linearised":
        """Weight a stretch's regressors, and take the unknown start out of them.

        Parameters
        ----------
        columns
            Derivatives of the free run by the curve's ordinates and the dynamics' parameters,
            shape (n, d + 1 + q).
        fading_shape
            Derivative of the free run by the settled speed before it, as far as there is any.
        weights
            How much each row counts.
        residual_rad_s
            Measured minus free-running speed, shape (n,).
        settled_rad_s, point
            As in `Linearised`.
        """
        shape = of_unit_length(times(1.0 / weights.spread, fading_shape))
        return cls(
            without(shape, times(1.0 / weights.spread, columns)),
            weights.robust * weights.root * residual_rad_s,
            weights.robust * (5.0 * weights.robust - 4.0),
            settled_rad_s,
            point,
        )


class Linearisation:
    """All stretches of a problem near its estimate.

    Parameters
    ----------
    pieces
        The stretches; every operating point has one at least.
    """

    def __init__(self, pieces: Sequence[Linearised]) -> None:
        self.pieces = tuple(pieces)

    @property
    def n(self) -> int:
        """Number of rows."""
        return sum(piece.slope.size for piece in self.pieces)

    @property
    def slope(self) -> float:
        """Mean slope of the influences."""
        return sum(float(piece.slope.sum()) for piece in self.pieces) / self.n

    def at(self, point: int) -> list[Linearised]:
        """Return the stretches of an operating point.

        Parameters
        ----------
        point
            Index of the operating point.
        """
        return [piece for piece in self.pieces if piece.point == point]

    @cached_property
    def factors(self) -> tuple[Array, ...]:
        """Triangular factor of each operating point's regressors."""
        points = range(1 + max(piece.point for piece in self.pieces))
        return tuple(triangle(*(p.regressors for p in self.at(point))) for point in points)
