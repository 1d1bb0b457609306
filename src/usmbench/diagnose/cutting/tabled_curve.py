"""A static curve that is asked over and over."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LOW_DEG, _HIGH_DEG, _CELLS = -200.0, 200.0, 16_384
NODES_DEG: Array = np.linspace(_LOW_DEG, _HIGH_DEG, _CELLS + 1)
"""Phases at which curves are tabled, evenly spaced, so that none has to be searched for."""


class TabledCurve:
    """A static curve row by row, by linear interpolation in a fine table.

    Parameters
    ----------
    speed_rad_s
        Speeds at `NODES_DEG`, one array a point.
    weights
        Weight of each point on each row, shape (N,) each.
    own_deg
        The rows' own phases, for which the curve is asked over and over, shape (N,).
    """

    def __init__(self, speed_rad_s: Sequence[Array], weights: Sequence[Array], own_deg: Array):
        used = [k for k, w in enumerate(weights) if np.any(w)] or [0]
        self._parts = [(speed_rad_s[k], np.diff(speed_rad_s[k]), weights[k]) for k in used]
        self._own_deg, self._own_rad_s = own_deg, self._looked_up(own_deg)
        self._own_rad_s.flags.writeable = False

    def __call__(self, phase_deg: Array) -> Array:
        """Return the settled speed of each row.

        Parameters
        ----------
        phase_deg
            Phase of each row, shape (N,).
        """
        return self._own_rad_s if phase_deg is self._own_deg else self._looked_up(phase_deg)

    def _looked_up(self, phase_deg: Array) -> Array:
        place = np.clip((phase_deg - _LOW_DEG) * (_CELLS / (_HIGH_DEG - _LOW_DEG)), 0.0, _CELLS)
        left = np.minimum(place.astype(np.intp), _CELLS - 1)
        total = np.zeros(left.size)
        for table, rise, weight in self._parts:
            total += weight * (table.take(left) + (place - left) * rise.take(left))
        return total
