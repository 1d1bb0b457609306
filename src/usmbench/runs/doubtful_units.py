"""Values that look like another unit than their column's name says."""

from collections.abc import Sequence

import numpy as np

from usmbench.runs.record import Record
from usmbench.runs.time_step import alike

_RADIAN_DEG = 3.2  # a sweep that stays within is hardly one: π and a little
_LONGEST_WINDOW_S = 1.0  # a hundred times the usual one
_FASTEST_RAD_S = 40.0  # a USR60 turns 150 rpm at most (its data sheet), which is 15.7 rad/s


def doubtful_units(records: Sequence[Record]) -> list[str]:
    """Warn of columns that look like radians, milliseconds or rpm, one line each.

    Parameters
    ----------
    records
        The runs, each of one row at least.
    """
    return [f"{record.name}: {doubt}" for record in records for doubt in _doubts(record)]


def _doubts(record: Record) -> list[str]:
    """Return what to say of one run."""
    farthest_deg = float(np.max(np.abs(record.phase_deg)))
    window_s = record.usual_window_s
    top_rad_s = float(np.max(np.abs(record.speed_rad_s)))
    doubts = []
    if np.unique(record.phase_deg).size > 1 and farthest_deg < _RADIAN_DEG:
        doubts.append(
            f"phase_deg stays within {farthest_deg:.3g}°; if these are radians, multiply by 57.3"
        )
    apart_s = float(np.median(np.diff(record.t_s))) if record.t_s.size > 1 else window_s
    if window_s > _LONGEST_WINDOW_S or alike(apart_s, 1e3 * window_s):
        doubts.append(
            f"t_s says that a window ends every {apart_s:.3g} s; if these are milliseconds, divide "
            "by 1000"
        )
    if top_rad_s > _FASTEST_RAD_S:
        doubts.append(
            f"speed_rad_s reaches {top_rad_s:.3g} rad/s; if these are rpm, divide by 9.55"
        )
    return doubts
