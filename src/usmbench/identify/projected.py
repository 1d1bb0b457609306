"""The output-error problem at given dynamics, with curves and unknown starts eliminated.

What the motor did before a segment is unknown: the settled speed before its first sample is one
more linear parameter, projected out of the segment's own rows. Everything goes through orthogonal
factors; no normal equations are formed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.design import Stretch
from usmbench.identify.dynamics import Dynamics, Family
from usmbench.identify.sensitivities import output_sensitivities
from usmbench.identify.triangle import triangle
from usmbench.model.linear import fading

Array = NDArray[np.float64]

_RANK = 1e-12  # singular values below this share of the largest are not resolved by the data


@dataclass(frozen=True, slots=True)
class RowWeights:
    """How much each row of a stretch counts.

    Parameters
    ----------
    spread
        Standard deviation of the row's kind over that of the quietest kind, shape (n,).
    robust
        Square root of the row's robust weight, 0 for an outlier and 1 in the middle, shape (n,).
    """

    spread: Array
    robust: Array

    @property
    def root(self) -> Array:
        """Square root of the whole weight, shape (n,)."""
        root: Array = self.robust / self.spread
        return root


@dataclass(frozen=True, slots=True)
class Fit:
    """Where the search stands.

    Parameters
    ----------
    parameters
        Parameters of the linear part in its family.
    dynamics
        The linear part.
    delta
        Ordinates of each operating point's curve.
    start_rad_s
        Settled speed before each stretch.
    residual_rad_s
        Measured minus free-running speed of each stretch.
    sse
        Weighted sum of squared residuals, with the penalty on the curves.
    """

    parameters: Array
    dynamics: Dynamics
    delta: tuple[Array, ...]
    start_rad_s: tuple[float, ...]
    residual_rad_s: tuple[Array, ...]
    sse: float


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
            Derivative of the free run by the settled speed before it, shape (n,).
        weights
            How much each row counts.
        residual_rad_s
            Measured minus free-running speed, shape (n,).
        settled_rad_s, point
            As in `Linearised`.
        """
        shape = _of_unit_length(fading_shape / weights.spread)
        return cls(
            _without(shape, columns / weights.spread[:, None]),
            weights.robust * weights.root * residual_rad_s,
            weights.robust * (5.0 * weights.robust - 4.0),
            settled_rad_s,
            point,
        )


class Projected:
    """The problem at given dynamics, with curves and starts eliminated orthogonally.

    Parameters
    ----------
    stretches, family, weights, penalties
        As in `fit_output_error`.
    parameters
        Of the linear part.
    """

    def __init__(
        self,
        stretches: Sequence[Stretch],
        family: Family,
        parameters: Array,
        weights: Sequence[RowWeights],
        penalties: Sequence[Array],
    ) -> None:
        self._stretches, self._weights, self.penalties = stretches, weights, penalties
        self._family, self._parameters = family, parameters
        self._dynamics = family.dynamics(parameters)
        self._members = [
            [k for k, s in enumerate(stretches) if s.point == point]
            for point in range(len(penalties))
        ]
        longest, dynamics = max(s.speed_rad_s.size for s in stretches), self._dynamics
        self._shape = fading(dynamics.numerator, dynamics.a, dynamics.dead_time_windows, longest)
        self._fading = [_of_unit_length(w.root * self._fading_of(k)) for k, w in enumerate(weights)]
        self._columns = [self._dynamics.respond(s.basis) for s in stretches]
        self._matrices = [self._weighted(k, c) for k, c in enumerate(self._columns)]
        self.fit = self._solve()

    def _fading_of(self, k: int) -> Array:
        return self._shape[: self._stretches[k].speed_rad_s.size]

    def _weighted(self, k: int, columns: Array) -> Array:
        """Weight a stretch's columns and take the start's response out of them."""
        return _without(self._fading[k], _times(self._weights[k].root, columns))

    def _solve(self) -> Fit:
        """Find the curves, point by point."""
        deltas: list[Array] = []
        residuals = [np.empty(0)] * len(self._stretches)
        starts = [0.0] * len(self._stretches)
        sse = 0.0
        for members, penalty in zip(self._members, self.penalties, strict=True):
            measured = [self._weighted(k, self._stretches[k].speed_rad_s) for k in members]
            target = np.concatenate([*measured, np.zeros(penalty.shape[0])])
            matrix = np.vstack([*(self._matrices[k] for k in members), penalty])
            factor = triangle(np.column_stack([matrix, target]))
            solved = np.linalg.lstsq(factor[:, :-1], factor[:, -1], rcond=_RANK)[0]
            delta = np.asarray(solved, dtype=np.float64)
            deltas.append(delta)
            sse += float(np.sum((target - matrix @ delta) ** 2))
            for k in members:
                starts[k], residuals[k] = self._with_start(k, self._columns[k] @ delta)
        return Fit(
            self._parameters,
            self._dynamics,
            tuple(deltas),
            tuple(starts),
            tuple(residuals),
            sse,
        )

    def _with_start(self, k: int, output_rad_s: Array) -> tuple[float, Array]:
        """Start and residual of a stretch, given its output from rest."""
        stretch, weight = self._stretches[k], self._weights[k].root
        shape = self._fading_of(k)
        weighted = weight * shape
        residual = stretch.speed_rad_s - output_rad_s
        power = float(weighted @ weighted)
        start = float(weighted @ (weight * residual)) / power if power > 1e-12 else 0.0
        return start, residual - start * shape

    def reduced(self) -> tuple[Array, Array]:
        """Return Jacobian and residual of the dynamics, projected off curves and starts.

        Returns
        -------
        jacobian, residual
            Of equal height: the last rows of the triangular factor of curves, dynamics and
            residual side by side, which is all that the rows say about the dynamics.
        """
        fit, n = self.fit, self._parameters.size
        jacobians, residuals = [], []
        for members, penalty in zip(self._members, self.penalties, strict=True):
            blocks = [self._block(k) for k in members]
            delta = fit.delta[self._stretches[members[0]].point]
            pulled = np.column_stack([penalty, np.zeros((penalty.shape[0], n)), -penalty @ delta])
            factor = triangle(np.vstack([*blocks, pulled]))
            first = delta.size
            jacobians.append(factor[first:, first:-1])
            residuals.append(factor[first:, -1])
        return np.vstack(jacobians), np.concatenate(residuals)

    def linearised(self) -> list[Linearised]:
        """Return every stretch's regressors and influences, for the covariance."""
        pieces = []
        for k, (stretch, weights) in enumerate(zip(self._stretches, self._weights, strict=True)):
            pieces.append(
                Linearised.of(
                    np.hstack([self._columns[k], self._sensitivities(k)]),
                    self._fading_of(k),
                    weights,
                    self.fit.residual_rad_s[k],
                    stretch.basis @ self.fit.delta[stretch.point],
                    stretch.point,
                )
            )
        return pieces

    def _sensitivities(self, k: int) -> Array:
        """Return the derivatives of a stretch's free run by the family's parameters."""
        stretch, fit = self._stretches[k], self.fit
        moved_rad_s = stretch.basis @ fit.delta[stretch.point] - fit.start_rad_s[k]
        slopes = output_sensitivities(fit.dynamics, moved_rad_s)
        product: Array = slopes @ self._family.jacobian(fit.parameters)
        return product

    def _block(self, k: int) -> Array:
        """Weighted regressors of curve and dynamics beside the residual, of one stretch."""
        sensitivities = self._weighted(k, self._sensitivities(k))
        residual = self._weighted(k, self.fit.residual_rad_s[k])
        return np.column_stack([self._matrices[k], sensitivities, residual])


def _times(weight: Array, columns: Array) -> Array:
    """Weight the rows of one or several columns."""
    weighted: Array = columns * (weight if columns.ndim == 1 else weight[:, None])
    return weighted


def _of_unit_length(shape: Array) -> Array:
    """Scale a shape to unit length, or to 0 where it is none."""
    scaled: Array = shape / max(float(np.linalg.norm(shape)), 1e-300)
    return scaled


def _without(shape: Array, columns: Array) -> Array:
    """Project columns off a shape of unit length."""
    left: Array = columns - np.multiply.outer(shape, shape @ columns)
    return left
