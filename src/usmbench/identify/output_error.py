"""Output-error estimation: the free run is fitted, with the curve eliminated.

For fixed dynamics the free-running output is linear in the curve's ordinates δ, so only the few
coefficients of the dynamics are searched (variable projection; Golub and Pereyra 1973,
doi:10.1137/0710036, with Kaufman's Jacobian). The gain is 1 by construction: the numerator is
``(1 + Σa) β`` with ``Σβ = 1``.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.design import Stretch
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import delayed, filtered

Array = NDArray[np.float64]

_RANK = 1e-10  # singular values below this share of the largest are not resolved by the data
_STABLE = 0.9999
_MAX_STEPS = 50
_TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class Dynamics:
    """Free parameters of the linear part.

    Parameters
    ----------
    a
        Denominator a_1 …, shape (n_a,).
    beta
        Numerator of unit sum without its first element, shape (n_b,).
    dead_time_windows
        Whole windows of dead time.
    """

    a: Array
    beta: Array
    dead_time_windows: int

    @property
    def numerator(self) -> Array:
        """Return b, shape (n_b + 1,)."""
        unit = np.r_[1.0 - self.beta.sum(), self.beta]
        b: Array = (1.0 + self.a.sum()) * unit
        return b

    @property
    def stable(self) -> bool:
        """Whether every pole lies inside the unit circle."""
        return bool(np.max(np.abs(np.roots(np.r_[1.0, self.a])), initial=0.0) < _STABLE)

    def moved(self, step: Array) -> "Dynamics":
        """Return the dynamics after a step.

        Parameters
        ----------
        step
            Change of a, then of beta, shape (n_a + n_b,).
        """
        na = self.a.size
        return Dynamics(self.a + step[:na], self.beta + step[na:], self.dead_time_windows)

    def linear_part(self, window_s: float | None) -> LinearPart:
        """Return the difference equation.

        Parameters
        ----------
        window_s
            Time step.
        """
        return LinearPart(self.a, self.numerator, self.dead_time_windows, window_s)


@dataclass(frozen=True, slots=True)
class Fit:
    """Where the search stands.

    Parameters
    ----------
    dynamics
        The linear part.
    delta
        Ordinates of each operating point's curve.
    output_rad_s
        Free-running output of each stretch.
    sse
        Weighted sum of squared residuals.
    """

    dynamics: Dynamics
    delta: tuple[Array, ...]
    output_rad_s: tuple[Array, ...]
    sse: float


def solve_curves(stretches: Sequence[Stretch], dynamics: Dynamics, weights: Sequence[Array]) -> Fit:
    """Return the best curves for given dynamics.

    Parameters
    ----------
    stretches
        Regressors of each segment.
    dynamics
        The linear part.
    weights
        Square roots of the weights of each segment's rows.
    """
    return _Projected(stretches, dynamics, weights).fit


def fit_output_error(
    stretches: Sequence[Stretch], start: Dynamics, weights: Sequence[Array]
) -> Fit:
    """Fit dynamics and curves to the free run.

    Parameters
    ----------
    stretches
        Regressors of each segment.
    start
        Dynamics to start from; stable.
    weights
        Square roots of the weights of each segment's rows.

    Returns
    -------
    Fit
        At a minimum of the weighted sum of squares, or where no step lowers it.
    """
    here = _Projected(stretches, start, weights)
    damping = 1e-6
    for _ in range(_MAX_STEPS):
        jacobian, residual = here.reduced()
        if jacobian.shape[1] == 0:
            break
        scale = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-300)
        step = _damped_step(jacobian / scale, residual, damping) / scale
        moved = here.fit.dynamics.moved(step)
        there = _Projected(stretches, moved, weights) if moved.stable else None
        if there is None or not there.fit.sse < here.fit.sse:
            damping *= 10.0
            if damping > 1e6:
                break
            continue
        gained = here.fit.sse - there.fit.sse
        here, damping = there, max(damping / 10.0, 1e-12)
        if gained <= _TOLERANCE * here.fit.sse:
            break
    return here.fit


def _damped_step(jacobian: Array, residual: Array, damping: float) -> Array:
    """Solve the damped least-squares problem by an orthogonal factorisation."""
    size = jacobian.shape[1]
    stacked = np.vstack([jacobian, np.sqrt(damping) * np.eye(size)])
    step: Array = np.linalg.lstsq(stacked, np.r_[residual, np.zeros(size)], rcond=None)[0]
    return step


class _Projected:
    """The problem at given dynamics, with the curves eliminated by an orthogonal projection."""

    def __init__(
        self, stretches: Sequence[Stretch], dynamics: Dynamics, weights: Sequence[Array]
    ) -> None:
        self._stretches = stretches
        self._weights = weights
        self._dynamics = dynamics
        self._members = [
            [k for k, s in enumerate(stretches) if s.point == point]
            for point in range(1 + max(s.point for s in stretches))
        ]
        self._spans: list[Array] = []
        deltas: list[Array] = []
        outputs: list[Array] = [np.empty(0)] * len(stretches)
        sse = 0.0
        for members in self._members:
            columns = [self._filtered_basis(k) for k in members]
            weighted = np.vstack(
                [weights[k][:, None] * c for k, c in zip(members, columns, strict=True)]
            )
            target = self._stack(members, [s.speed_rad_s for s in stretches])
            left, singular, right = np.linalg.svd(weighted, full_matrices=False)
            kept = singular > _RANK * singular[0]
            self._spans.append(left[:, kept])
            delta = right[kept].T @ ((left[:, kept].T @ target) / singular[kept])
            deltas.append(delta)
            for k, c in zip(members, columns, strict=True):
                outputs[k] = c @ delta
            sse += float(np.sum((target - weighted @ delta) ** 2))
        self.fit = Fit(dynamics, tuple(deltas), tuple(outputs), sse)

    def _filtered_basis(self, k: int) -> Array:
        late = delayed(self._stretches[k].basis, self._dynamics.dead_time_windows)
        return filtered(self._dynamics.numerator, self._dynamics.a, late)

    def _stack(self, members: Sequence[int], signals: Sequence[Array]) -> Array:
        return np.concatenate([self._weights[k] * signals[k] for k in members])

    def reduced(self) -> tuple[Array, Array]:
        """Return Jacobian and residual of the dynamics, projected off the curves' span."""
        stretches, outputs = self._stretches, self.fit.output_rad_s
        residuals = [s.speed_rad_s - y for s, y in zip(stretches, outputs, strict=True)]
        columns = [
            output_sensitivities(self._dynamics, s.basis @ self.fit.delta[s.point], y)
            for s, y in zip(stretches, outputs, strict=True)
        ]
        jacobian, residual = [], []
        for members, span in zip(self._members, self._spans, strict=True):
            block = np.vstack([self._weights[k][:, None] * columns[k] for k in members])
            jacobian.append(block - span @ (span.T @ block))
            residual.append(self._stack(members, residuals))
        return np.vstack(jacobian), np.concatenate(residual)


def output_sensitivities(dynamics: Dynamics, settled_rad_s: Array, output_rad_s: Array) -> Array:
    """Return the derivatives of the free run with respect to a and beta.

    Parameters
    ----------
    dynamics
        The linear part.
    settled_rad_s
        The static curve's output v, shape (n,).
    output_rad_s
        The free run, shape (n,).

    Returns
    -------
    Array
        Shape (n, n_a + n_b): ``(β(q) v(t−D) − ω(t−i)) / A(q)`` for a_i, and
        ``(1 + Σa) (v(t−D−i) − v(t−D)) / A(q)`` for β_i.
    """
    late = delayed(settled_rad_s, dynamics.dead_time_windows)
    gain = 1.0 + dynamics.a.sum()
    unit = dynamics.numerator / gain
    mixed = filtered(unit, np.empty(0), late)
    inputs = [mixed - delayed(output_rad_s, i + 1) for i in range(dynamics.a.size)]
    inputs += [gain * (delayed(late, i + 1) - late) for i in range(dynamics.beta.size)]
    if not inputs:
        return np.empty((settled_rad_s.size, 0))
    return filtered(np.ones(1), dynamics.a, np.column_stack(inputs))
