"""When the motor was driven in a run whose rows are still coming in."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from usmbench.model.driving import ALWAYS, Driving, driving, stops

Array = NDArray[np.float64]

_MOST: Final = 1000  # switches that are kept one by one


class DrivenSoFar:
    """Follows a run's drive, in bounded memory.

    Parameters
    ----------
    window_s
        Duration of the run's windows.
    """

    def __init__(self, window_s: float):
        self._window_s = window_s
        self._last: Array = np.empty((0, 2))
        self.driving = ALWAYS

    def add(self, t_s: Array, drive_on: Array) -> NDArray[np.intp]:
        """Take the next rows, and return those before which the motor may have stood, unseen.

        Parameters
        ----------
        t_s
            End of each window, rising, shape (n,).
        drive_on
            1 where it was driven, 0 where not, NaN where the run does not say, shape (n,).
        """
        rows = np.vstack([self._last, np.column_stack([t_s, drive_on])])
        ends_s, on = rows.T
        driven = None if np.isnan(on).any() else on != 0.0
        new = driving(ends_s, self._window_s, driven)
        starts = stops(ends_s, self._window_s, driven) - len(self._last)
        self.driving = _bounded(_joined(self.driving, new) if len(self._last) else new)
        self._last = rows[-1:]
        return starts


def _joined(before: Driving, new: Driving) -> Driving:
    """Return both; the new one begins as the one before has ended."""
    from_s, share = np.r_[before.from_s, new.from_s[1:]], np.r_[before.share, new.share[1:]]
    return Driving(from_s, share)


def _bounded(known: Driving) -> Driving:
    """Return the last switches, and what was before them as one mean."""
    if known.from_s.size <= 2 * _MOST:
        return known
    first = known.from_s.size - _MOST
    mean = known.driven_s(known.from_s[[first]]) / known.from_s[first]
    return Driving(np.r_[0.0, known.from_s[first:]], np.r_[mean, known.share[first:]])
