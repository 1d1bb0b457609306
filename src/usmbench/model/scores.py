"""How well a simulation meets a measurement."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def rmse(measured: Array, simulated: Array) -> float:
    """Return the root mean square difference, in the unit of its arguments.

    Parameters
    ----------
    measured, simulated
        Two signals, shape (N,), N at least 1.
    """
    return float(np.sqrt(np.mean((measured - simulated) ** 2)))


def fit_percent(measured: Array, simulated: Array) -> float | None:
    """Return ``100 (1 − ‖ω − ω̂‖ / ‖ω − mean ω‖)``.

    Parameters
    ----------
    measured, simulated
        ω and ω̂, shape (N,), N at least 1.

    Returns
    -------
    float or None
        100 for a perfect fit, 0 for one as good as the mean; None where the measurement is
        constant, which leaves the figure without a meaning.
    """
    spread = float(np.linalg.norm(measured - measured.mean()))
    if spread == 0.0:
        return None
    return 100.0 * (1.0 - float(np.linalg.norm(measured - simulated)) / spread)
