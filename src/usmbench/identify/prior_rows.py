"""What is known about a curve without data: rows of its least squares whose outcome is 0."""

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.between_levels import Levels
from usmbench.model.bernstein import bernstein_basis
from usmbench.model.inverse_map import bezier_abscissa

Array = NDArray[np.float64]

_STANDING_ROWS, _STANDING_WEIGHT = 25, 0.1


def prior_rows(
    knots_deg: Array,
    stiffness: float,
    standing_deg: tuple[float, float] | None,
    n: int,
    levels: Levels | None = None,
) -> Array:
    """Return rows that say what is known about a curve without data; their outcome is 0.

    Parameters
    ----------
    knots_deg
        The knots, shape (d + 1,).
    stiffness
        Noise of one sample over the expected size of a second difference of δ, both in rad/s.
    standing_deg
        Lowest and highest phase at which the motor stood, or None: it stands in between, as
        static friction that holds against two drives holds against any drive between them.
    n
        Number of samples the rows stand beside: what is known keeps its share.
    levels
        Between which levels the curve is held; None where it is free.

    Returns
    -------
    Array
        Shape (m, d + 1).
    """
    degree = knots_deg.size - 1
    smooth: Array = stiffness * np.sqrt(n) * np.diff(np.eye(degree + 1), 2, axis=0)
    if levels is not None:
        smooth = np.vstack([smooth, np.sqrt(n) * levels.pull(knots_deg)])
    if standing_deg is None:
        return smooth
    low_deg, high_deg = np.clip(standing_deg, knots_deg[0], knots_deg[-1]).tolist()
    phase_deg = np.linspace(low_deg, high_deg, _STANDING_ROWS)
    still = bernstein_basis(bezier_abscissa(phase_deg, knots_deg), degree)
    return np.vstack([smooth, _STANDING_WEIGHT * np.sqrt(n) * still])
