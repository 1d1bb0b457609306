"""A static curve that is asked over and over."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class TabledCurve:
    """A static curve row by row, by linear interpolation in a fine table.

    Parameters
    ----------
    phase_deg
        Nodes, shape (K,).
    speed_rad_s
        Speeds at the nodes, one array a point.
    weights
        Weight of each point on each row, shape (N,) each.
    own_deg
        The rows' own phases, for which the curve is asked over and over, shape (N,).
    """

    def __init__(
        self,
        phase_deg: Array,
        speed_rad_s: Sequence[Array],
        weights: Sequence[Array],
        own_deg: Array,
    ):
        self._phase_deg, self._speed_rad_s, self._weights = phase_deg, speed_rad_s, weights
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
        parts = [
            w * np.interp(phase_deg, self._phase_deg, s)
            for w, s in zip(self._weights, self._speed_rad_s, strict=True)
        ]
        total: Array = sum(parts[1:], parts[0])
        return total
