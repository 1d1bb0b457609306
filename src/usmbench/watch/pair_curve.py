"""The measured φ–ω pairs of the operating point under way, in bounded memory."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Below the resolution of the page; a random excitation has thousands of phases.
_PHASE_BIN_DEG = 0.25


class PairCurve:
    """Latest speed for each phase and direction at one operating point."""

    def __init__(self) -> None:
        self._point: tuple[float, float] | None = None
        self._pairs: dict[tuple[int, int], tuple[float, float]] = {}

    def add(self, pairs: Array) -> None:
        """Take pairs; the first at another operating point starts a new curve.

        Parameters
        ----------
        pairs
            Phase in degrees, speed in rad/s, direction, frequency in Hz and torque in N·m, NaN
            where the last two are unknown; shape (n, 5).
        """
        for phase_deg, speed_rad_s, direction, *point in np.nan_to_num(pairs).tolist():
            if tuple(point) != self._point:
                self._point = (point[0], point[1])
                self._pairs.clear()
            key = (1 if direction > 0 else -1, round(phase_deg / _PHASE_BIN_DEG))
            self._pairs[key] = (round(phase_deg, 3), round(speed_rad_s, 4))

    def columns(self) -> dict[str, Any]:
        """Return phases and speeds of the rising and of the falling passes, as lists."""
        columns = {}
        for name, sign in (("rising", 1), ("falling", -1)):
            pairs = sorted(pair for (way, _), pair in self._pairs.items() if way == sign)
            columns[name] = {
                "phase_deg": [phase_deg for phase_deg, _ in pairs],
                "speed_rad_s": [speed_rad_s for _, speed_rad_s in pairs],
            }
        return columns
