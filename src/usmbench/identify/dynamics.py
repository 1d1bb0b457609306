"""Linear parts of unit gain, and families of them to search in; free coefficients are one."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import from_rest, poles

Array = NDArray[np.float64]

_STABLE = 0.9999


@dataclass(frozen=True, slots=True)
class Dynamics:
    """A linear part of unit gain: ``b = (1 + Σa) β`` with ``Σβ = 1``.

    Parameters
    ----------
    a
        Denominator a_1 …, shape (n_a,).
    beta
        Numerator of unit sum without its first element, shape (n_b,).
    dead_time_windows
        Whole windows of dead time.
    slip_limit_rad_s
        Slip at which the torque gives out; None where the dynamics are linear.
    """

    a: Array
    beta: Array
    dead_time_windows: int
    slip_limit_rad_s: float | None = None

    @property
    def numerator(self) -> Array:
        """Return b, shape (n_b + 1,)."""
        unit = np.concatenate(([1.0 - self.beta.sum()], self.beta))
        numerator: Array = (1.0 + float(self.a.sum())) * unit
        return numerator

    @property
    def stable(self) -> bool:
        """Whether every pole lies inside the unit circle."""
        return bool(np.max(np.abs(poles(self.a)), initial=0.0) < _STABLE)

    def linear_part(self, window_s: float | None) -> LinearPart:
        """Return the difference equation.

        Parameters
        ----------
        window_s
            Time step.
        """
        return LinearPart(
            self.a, self.numerator, self.dead_time_windows, window_s, self.slip_limit_rad_s
        )

    def respond(self, signal: Array) -> Array:
        """Run the dynamics, without their torque limit, over a signal that was 0 before.

        Parameters
        ----------
        signal
            Shape (N,) or (N, K).
        """
        return from_rest(self.numerator, self.a, self.dead_time_windows, signal)


NONE = Dynamics(np.empty(0), np.empty(0), 0)
"""No dynamics: the output is the input."""


class Parametrised(Protocol):
    """Dynamics that a few parameters span."""

    def dynamics(self, parameters: Array) -> Dynamics:
        """Return the dynamics at these parameters."""

    def moved(self, parameters: Array, step: Array) -> Array:
        """Return the parameters after a step, kept where they make sense."""


class Family(Parametrised, Protocol):
    """Linear dynamics that a few parameters span."""

    def parameters(self, dynamics: Dynamics) -> Array:
        """Return the parameters nearest to a linear part."""

    def jacobian(self, parameters: Array) -> Array:
        """Return the derivatives of (a, β), shape (n_a + n_b, n)."""


@dataclass(frozen=True, slots=True)
class FreeFamily:
    """Difference equations with free coefficients; the parameters are (a, β).

    Parameters
    ----------
    na, nb
        Orders.
    dead_time_windows
        Dead time.
    """

    na: int
    nb: int
    dead_time_windows: int

    def dynamics(self, parameters: Array) -> Dynamics:
        """Return the linear part.

        Parameters
        ----------
        parameters
            a, then β, shape (n_a + n_b,).
        """
        return Dynamics(parameters[: self.na], parameters[self.na :], self.dead_time_windows)

    def parameters(self, dynamics: Dynamics) -> Array:
        """Return (a, β).

        Parameters
        ----------
        dynamics
            Of the same orders.
        """
        joined: Array = np.r_[dynamics.a, dynamics.beta]
        return joined

    def moved(self, parameters: Array, step: Array) -> Array:
        """Return the sum.

        Parameters
        ----------
        parameters, step
            Where from and how far, shape (n_a + n_b,).
        """
        moved: Array = parameters + step
        return moved

    def jacobian(self, parameters: Array) -> Array:
        """Return the unit matrix.

        Parameters
        ----------
        parameters
            (a, β).
        """
        return np.eye(parameters.size)
