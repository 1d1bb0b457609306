"""A motor that starts with a jump on each side."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def settled_rad_s(
    phase_deg: Array, edges_deg: tuple[float, float], jumps_rad_s: tuple[float, float]
) -> Array:
    """Return speeds that begin with a jump on each side, and saturate."""
    (low_deg, high_deg), (down, up) = edges_deg, jumps_rad_s
    forward = up - 9.0 * np.expm1(-(phase_deg - high_deg) / 40.0)
    backward = -down + 9.0 * np.expm1((phase_deg - low_deg) / 40.0)
    return np.where(phase_deg > high_deg, forward, np.where(phase_deg < low_deg, backward, 0.0))
