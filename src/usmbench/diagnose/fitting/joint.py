"""All parameters of several effects as one vector, and what they leave of the residual."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied

Array = NDArray[np.float64]

_STEP_SHARE = 0.05  # of the typical size, for derivatives


class Joint:
    """All parameters of several effects as one vector.

    Parameters
    ----------
    problem
        The problem.
    applied
        The effects, with the values to start from.
    """

    def __init__(self, problem: Problem, applied: Sequence[Applied]):
        self._problem, self._effects = problem, [a.effect for a in applied]
        self.parameters = [p for e in self._effects for p in e.parameters]
        self.start = self.vector(applied)

    def vector(self, applied: Sequence[Applied]) -> Array:
        """Return the values of effects.

        Parameters
        ----------
        applied
            The effects with their values.

        Returns
        -------
        numpy.ndarray
            Shape (P,), in the order of `parameters`.
        """
        return np.array([a.values[p.name] for a in applied for p in a.effect.parameters])

    def applied(self, theta: Array) -> tuple[Applied, ...]:
        """Return the effects at these values.

        Parameters
        ----------
        theta
            The values, shape (P,).
        """
        found, at = [], 0
        for effect in self._effects:
            own = {p.name: float(theta[at + i]) for i, p in enumerate(effect.parameters)}
            found.append(Applied(effect, own))
            at += len(own)
        return tuple(found)

    def clipped(self, theta: Array) -> Array:
        """Return the nearest values that may be.

        Parameters
        ----------
        theta
            The values, shape (P,).
        """
        low = np.array([p.low for p in self.parameters])
        high = np.array([p.high for p in self.parameters])
        return np.asarray(np.clip(theta, low, high), dtype=np.float64)

    def left(self, theta: Array) -> Array:
        """Return the carried residual that is left, shape (M,).

        Parameters
        ----------
        theta
            The values, shape (P,).
        """
        return self._problem.left(self.applied(theta))

    def deviance(self, theta: Array) -> float:
        """Return the deviance of what is left.

        Parameters
        ----------
        theta
            The values, shape (P,).
        """
        return self._problem.square(self._problem.left_rad_s(self.applied(theta)))

    def slopes(self, theta: Array) -> tuple[Array, Array]:
        """Return the products of the slopes of what is left with each other, and with it.

        Parameters
        ----------
        theta
            The values, shape (P,).

        Returns
        -------
        tuple of Array and Array
            JᵀJ and Jᵀr of the Jacobian J and what is left r, shape (P, P) and (P,).
        """
        left = self._problem.left_rad_s(self.applied(theta))
        signals = [np.concatenate(signal) for signal in (left, *self._slopes_rad_s(theta))]
        pulled = self._problem.pulled(np.column_stack(signals))
        products = pulled.products(pulled)
        return products[1:, 1:], products[1:, 0]

    def jacobian(self, theta: Array) -> Array:
        """Return how the carried residual changes with each parameter, shape (M, P).

        Parameters
        ----------
        theta
            The values, shape (P,).
        """
        slopes = zip(*self._slopes_rad_s(theta), strict=True)
        return self._problem.carried([np.column_stack(part) for part in slopes])

    def _slopes_rad_s(self, theta: Array) -> list[list[Array]]:
        """How what is left changes with each parameter, by stretch, shape (N,) each."""
        base = self._problem.change_rad_s(self.applied(theta))
        slopes = []
        for k, p in enumerate(self.parameters):
            step = _STEP_SHARE * p.typical
            if theta[k] + step > p.high:
                step = -step
            moved = theta.copy()
            moved[k] += step
            there = self._problem.change_rad_s(self.applied(moved))
            slopes.append([(b - t) / step for t, b in zip(there, base, strict=True)])
        return slopes
