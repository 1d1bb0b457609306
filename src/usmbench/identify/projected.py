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
from usmbench.identify.linearised import Linearisation, Linearised
from usmbench.identify.row_weights import RowWeights, of_unit_length, times, without
from usmbench.identify.sensitivities import output_sensitivities
from usmbench.identify.triangle import triangle
from usmbench.model.linear import fading

Array = NDArray[np.float64]

_RANK = 1e-12  # singular values below this share of the largest are not resolved by the data
_FADED = 1e-12  # share of a start that is nothing any more


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


class Projected:
    """The problem at given dynamics, with curves and starts eliminated orthogonally.

    Parameters
    ----------
    stretches
        Regressors of each segment.
    family
        Where the dynamics are searched.
    parameters
        Of the linear part.
    weights
        How much each segment's rows count.
    penalties
        Rows that pull each operating point's δ towards 0, shape (m, d + 1); see
        `usmbench.identify.prior_rows.prior_rows`.
    responses
        The dynamics' response to each segment's basis, where it is known from another weighting.
    """

    def __init__(
        self,
        stretches: Sequence[Stretch],
        family: Family,
        parameters: Array,
        weights: Sequence[RowWeights],
        penalties: Sequence[Array],
        responses: Sequence[Array] | None = None,
    ) -> None:
        self.stretches, self.weights, self.penalties = stretches, weights, penalties
        self.family, self._parameters = family, parameters
        self._dynamics = dynamics = family.dynamics(parameters)
        self._members = [
            [k for k, s in enumerate(stretches) if s.point == point]
            for point in range(len(penalties))
        ]
        longest = max(s.speed_rad_s.size for s in stretches)
        shape = fading(dynamics.numerator, dynamics.a, dynamics.dead_time_windows, longest)
        self._shape = shape[: 1 + int(np.max(np.flatnonzero(np.abs(shape) > _FADED), initial=-1))]
        self._fading = [
            of_unit_length(times(w.root, self._fading_of(k))) for k, w in enumerate(weights)
        ]
        self._columns = responses or [dynamics.respond(s.basis) for s in stretches]
        self._matrices = [self._weighted(k, c) for k, c in enumerate(self._columns)]
        self.fit = self._solve()

    def _fading_of(self, k: int) -> Array:
        """How the start of a stretch fades, as far as it does not before the stretch ends."""
        return self._shape[: self.stretches[k].speed_rad_s.size]

    def at(self, parameters: Array) -> "Projected":
        """Return the same problem at other dynamics.

        Parameters
        ----------
        parameters
            Of the linear part.
        """
        return Projected(self.stretches, self.family, parameters, self.weights, self.penalties)

    def reweighted(
        self, weights: Sequence[RowWeights], penalties: Sequence[Array] | None = None
    ) -> "Projected":
        """Return the problem at the same dynamics with other weights.

        Parameters
        ----------
        weights
            How much each segment's rows count.
        penalties
            Rows that pull each operating point's δ; None leaves them as they are.
        """
        return Projected(
            self.stretches,
            self.family,
            self._parameters,
            weights,
            penalties or self.penalties,
            self._columns,
        )

    def _weighted(self, k: int, columns: Array) -> Array:
        """Weight a stretch's columns and take the start's response out of them."""
        return without(self._fading[k], times(self.weights[k].root, columns))

    def _solve(self) -> Fit:
        """Find the curves, point by point."""
        deltas: list[Array] = []
        self._inverses: list[Array] = []
        residuals = [np.empty(0)] * len(self.stretches)
        starts = [0.0] * len(self.stretches)
        sse = 0.0
        for members, penalty in zip(self._members, self.penalties, strict=True):
            blocks = [np.column_stack([penalty, np.zeros(penalty.shape[0])])]
            for k in members:
                measured = self._weighted(k, self.stretches[k].speed_rad_s)
                blocks.append(np.column_stack([self._matrices[k], measured]))
            factor = triangle(*blocks)
            inverse = np.asarray(np.linalg.pinv(factor[:, :-1], rcond=_RANK), dtype=np.float64)
            delta = np.asarray(inverse @ factor[:, -1], dtype=np.float64)
            left = factor[:, -1] - factor[:, :-1] @ delta
            sse += float(left @ left)
            deltas.append(delta)
            self._inverses.append(inverse)
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
        residual = self.stretches[k].speed_rad_s - output_rad_s
        shape = self._fading_of(k)
        head, weight = residual[: shape.size], self.weights[k].root[: shape.size]
        weighted = weight * shape
        power = float(weighted @ weighted)
        start = float(weighted @ (weight * head)) / power if power > 1e-12 else 0.0
        head -= start * shape
        return start, residual

    def reduced(self) -> tuple[Array, Array]:
        """Return Jacobian and residual of the dynamics, projected off curves and starts.

        Returns
        -------
        jacobian, residual
            As of `off_curves`.
        """
        return self.off_curves(self._sensitivities())

    def off_curves(self, slopes: Sequence[Array], *, pulled: bool = True) -> tuple[Array, Array]:
        """Return derivatives and the residual, projected off curves and starts.

        The triangular factor of the curve's regressors projects; what it rounds turns the next
        step a little, and never what the steps come to.

        Parameters
        ----------
        slopes
            Derivatives of each stretch's free run by K parameters, shape (n, K) each.
        pulled
            Whether what is known of the curves without data counts.

        Returns
        -------
        jacobian, residual
            Of equal height: the triangular factor of both side by side, which is all that the
            rows say about the parameters.
        """
        rows = []
        for members, penalty, delta, inverse in zip(
            self._members, self.penalties, self.fit.delta, self._inverses, strict=True
        ):
            moved = [self._weighted(k, slopes[k]) for k in members]
            products = zip(members, moved, strict=True)
            moments = sum((self._matrices[k].T @ m for k, m in products), np.zeros(()))
            along = inverse @ (inverse.T @ moments)
            for k, own in zip(members, moved, strict=True):
                residual = self._weighted(k, self.fit.residual_rad_s[k])
                rows.append(np.column_stack([own - self._matrices[k] @ along, residual]))
            if pulled:
                rows.append(-penalty @ np.column_stack([along, delta]))
        factor = triangle(*rows)
        return factor[:, :-1], factor[:, -1]

    def linearised(self) -> Linearisation:
        """Return every stretch's regressors and influences, for the covariance."""
        slopes = self._sensitivities()
        pieces = [
            Linearised.of(
                np.hstack([self._columns[k], slopes[k]]),
                self._fading_of(k),
                weights,
                self.fit.residual_rad_s[k],
                stretch.basis @ self.fit.delta[stretch.point],
                stretch.point,
            )
            for k, (stretch, weights) in enumerate(zip(self.stretches, self.weights, strict=True))
        ]
        return Linearisation(pieces)

    def _sensitivities(self) -> list[Array]:
        """Return the derivatives of each stretch's free run by the family's parameters."""
        fit, jacobian = self.fit, self.family.jacobian(self.fit.parameters)
        slopes = []
        for stretch, start_rad_s in zip(self.stretches, fit.start_rad_s, strict=True):
            moved_rad_s = stretch.basis @ fit.delta[stretch.point] - start_rad_s
            slopes.append(output_sensitivities(fit.dynamics, moved_rad_s) @ jacobian)
        return slopes
