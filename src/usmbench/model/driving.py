"""When a motor was driven in a run, and so warmed, and when it stood and cooled.

A sweep that is taken up again begins with rows without drive: in the gap before them the drive was
off. Of any other gap nobody knows: a log may have been paused with the motor, or without it.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from usmbench.runs.record import Column, Record
from usmbench.runs.time_step import breaks

LOST_S: Final = 1.0  # a shorter gap is rows that were lost: nobody pauses for it
UNKNOWN: Final = 0.5  # as wrong whether it was driven or not


@dataclass(frozen=True, slots=True, eq=False)
class Driving:
    """How much a motor is driven from when on: 1 while it is, 0 while not, between where unknown.

    Parameters
    ----------
    from_s
        Times in the run, rising from 0, shape (K,).
    share
        What holds from each on, shape (K,).
    """

    from_s: Column
    share: Column

    def warmed(self, t_s: Column, constant_s: float) -> Column:
        """Return how warm it is, cold at 0, as a share of what driving makes it at last.

        Parameters
        ----------
        t_s
            Times, shape (N,).
        constant_s
            Thermal time constant.
        """
        kept = np.exp(-np.diff(self.from_s) / constant_s).tolist()
        warm = [0.0]
        for share, fades in zip(self.share.tolist(), kept, strict=False):
            warm.append(warm[-1] * fades + share * (1.0 - fades))
        last = self._last(t_s)
        gone = -np.expm1((self.from_s[last] - t_s) / constant_s)
        before = np.array(warm)[last]
        return np.asarray(before + (self.share[last] - before) * gone)

    def driven_s(self, t_s: Column) -> Column:
        """Return for how long it has been driven, shape (N,).

        Parameters
        ----------
        t_s
            Times, shape (N,).
        """
        before_s = np.r_[0.0, np.cumsum(np.diff(self.from_s) * self.share[:-1])]
        last = self._last(t_s)
        return np.asarray(before_s[last] + self.share[last] * (t_s - self.from_s[last]))

    def share_at(self, t_s: Column) -> Column:
        """Return how much it is driven, shape (N,).

        Parameters
        ----------
        t_s
            End of each window, shape (N,).
        """
        return self.share[self._last(t_s)]

    def _last(self, t_s: Column) -> NDArray[np.intp]:
        """Return which entry each window, which ends at its time, belongs to."""
        return np.maximum(np.searchsorted(self.from_s, t_s) - 1, 0)


ALWAYS: Final = Driving(np.zeros(1), np.ones(1))


def driving(t_s: Column, window_s: float, driven: NDArray[np.bool_] | None) -> Driving:
    """Return when a motor was driven.

    Parameters
    ----------
    t_s
        End of each window, rising, shape (N,).
    window_s
        Duration of a window.
    driven
        Which windows it was driven in, shape (N,); None where nobody knows, for all.
    """
    on = np.ones(t_s.size) if driven is None else driven.astype(np.float64)
    rows = breaks(t_s, window_s)
    begin_s = np.r_[t_s[0] - window_s, t_s[:-1]]
    begin_s[rows] = t_s[rows] - window_s
    # What comes before the first row is as in it.
    from_s, share = np.r_[0.0, t_s[rows - 1], begin_s], np.r_[on[0], in_gaps(t_s, rows, driven), on]
    order = np.argsort(from_s, kind="stable")
    from_s, share = np.maximum(from_s[order], 0.0), share[order]
    changes = np.flatnonzero(np.diff(share)) + 1
    kept = np.r_[0, changes]
    return Driving(from_s[kept], share[kept])


def in_gaps(t_s: Column, rows: NDArray[np.intp], driven: NDArray[np.bool_] | None) -> Column:
    """Return how much a motor was driven in gaps, shape (K,).

    Parameters
    ----------
    t_s
        End of each window, rising, shape (N,).
    rows
        The rows after the gaps, shape (K,).
    driven
        As in `driving`.
    """
    unknown = np.where(t_s[rows] - t_s[rows - 1] < LOST_S, 1.0, UNKNOWN)
    return unknown if driven is None else np.where(driven[rows], unknown, 0.0)


def stops(t_s: Column, window_s: float, driven: NDArray[np.bool_] | None) -> NDArray[np.intp]:
    """Return the rows before which the motor may have stood, unseen, shape (K,).

    Parameters
    ----------
    t_s, window_s, driven
        As in `driving`.
    """
    rows = breaks(t_s, window_s)
    return rows[in_gaps(t_s, rows, driven) < 1.0]


def driving_of(record: Record) -> Driving:
    """Return when the motor was driven in a run.

    Parameters
    ----------
    record
        The run.
    """
    return driving(record.t_s, record.usual_window_s, record.driven)
