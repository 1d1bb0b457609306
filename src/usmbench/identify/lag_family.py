"""The family of first-order lags with a true dead time."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.dynamics import Dynamics
from usmbench.model.effects.first_order import SOONER, lag_coefficients

Array = NDArray[np.float64]

_SHORTEST, _LONGEST = 0.02, 1e4  # time constant in windows
_STARTING_LAGS = (0.15, 1.0, 6.0)  # windows
LONGER_DEAD_TIME = 2.0  # windows by which a search may go beyond the dead time that it starts from
_DIFFERENCE = 1e-6


@dataclass(frozen=True, slots=True)
class LagFamily:
    """First-order lags with a true dead time, seen through window averages, or at windows' ends.

    The parameters are ln(τ/T) and the dead time over T, for windows of length T. Speeds are
    averages over windows unless sampled; a phase counts from the start of the window in which it
    is commanded.
    Their difference equation is that of `lag_coefficients`.

    Parameters
    ----------
    longest_dead_time
        Largest dead time in windows; 0 for none at all.
    sampled
        Whether speeds are those at the ends of windows.
    """

    longest_dead_time: float
    sampled: bool = False

    def dynamics(self, parameters: Array) -> Dynamics:
        """Return the linear part.

        Parameters
        ----------
        parameters
            ln(τ/T) and dead time over T, shape (2,).
        """
        u, dead = math.exp(parameters[0]), float(parameters[1])
        whole = _whole(dead)
        return self._at(u, whole, dead - whole)

    def _at(self, u: float, whole: int, f: float) -> Dynamics:
        pole, b = lag_coefficients(u, f, sampled=self.sampled)
        return Dynamics(np.array([-pole]), b[1:] / b.sum(), whole)

    def parameters(self, dynamics: Dynamics) -> Array:
        """Return the lag with the same pole and dead time.

        Parameters
        ----------
        dynamics
            With n_a = 1.
        """
        pole = min(max(-float(dynamics.a[0]), 0.02), 0.999)
        return np.array([math.log(-1.0 / math.log(pole)), dynamics.dead_time_windows + 0.25])

    def starts(self) -> list[Array]:
        """Return lags from short to long, without a dead time and with the one of the start.

        Returns
        -------
        list of Array
            Parameters, shape (2,) each.
        """
        dead_times = {0.0, max(self.longest_dead_time - LONGER_DEAD_TIME, 0.0)}
        return [
            np.array([math.log(lag), dead]) for lag in _STARTING_LAGS for dead in sorted(dead_times)
        ]

    def moved(self, parameters: Array, step: Array) -> Array:
        """Return the sum, with both parameters kept in their bounds.

        Parameters
        ----------
        parameters, step
            Where from and how far, shape (2,).
        """
        soonest = 0.0 if self.sampled or not self.longest_dead_time else -SOONER
        low = np.array([math.log(_SHORTEST), soonest])
        high = np.array([math.log(_LONGEST), self.longest_dead_time])
        moved: Array = np.clip(parameters + step, low, high)
        return moved

    def jacobian(self, parameters: Array) -> Array:
        """Return the derivatives of (a_1, β_1, β_2) by central differences within the window.

        By a dead time that may not be they are 0: no step goes there.

        Parameters
        ----------
        parameters
            ln(τ/T) and dead time over T, shape (2,).
        """
        u, dead = float(parameters[0]), float(parameters[1])
        whole = _whole(dead)
        f, h = dead - whole, _DIFFERENCE
        late = h if self.longest_dead_time else 0.0
        columns = [
            [self._at(math.exp(u + side * h), whole, f) for side in (1, -1)],
            [self._at(math.exp(u), whole, f + side * late) for side in (1, -1)],
        ]
        return np.column_stack(
            [
                np.concatenate((up.a - down.a, up.beta - down.beta)) / (2.0 * h)
                for up, down in columns
            ]
        )


def _whole(dead_windows: float) -> int:
    """Whole windows of a dead time, which may be a little below 0."""
    return max(math.floor(dead_windows), 0)
