"""How the free run moves with the coefficients of the dynamics."""

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.dynamics import Dynamics
from usmbench.model.linear import delayed, from_rest

Array = NDArray[np.float64]


def output_sensitivities(dynamics: Dynamics, moved_rad_s: Array) -> Array:
    """Return the derivatives of the free run with respect to a and beta.

    Parameters
    ----------
    dynamics
        The linear part.
    moved_rad_s
        The static curve's output v less its value before the first sample, shape (n,).

    Returns
    -------
    Array
        Shape (n, n_a + n_b): ``(β(q) v(t−D) − y(t−i)) / A(q)`` for a_i, and
        ``(1 + Σa) (v(t−D−i) − v(t−D)) / A(q)`` for β_i.
    """
    na, nb = dynamics.a.size, dynamics.beta.size
    gain = 1.0 + float(dynamics.a.sum())
    one = np.ones(1)
    late = from_rest(one, dynamics.a, dynamics.dead_time_windows, moved_rad_s)
    output = from_rest(dynamics.numerator, np.empty(0), 0, late)
    slow = from_rest(one, dynamics.a, 0, output) if na else output
    columns = np.empty((moved_rad_s.size, na + nb))
    for i in range(1, na + 1):
        columns[:, i - 1] = output / gain - delayed(slow, i)
    for i in range(1, nb + 1):
        columns[:, na + i - 1] = gain * (delayed(late, i) - late)
    return columns
