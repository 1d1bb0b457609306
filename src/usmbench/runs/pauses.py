"""Pauses in a run: where a run that is taken up again goes on, and what its motor did meanwhile."""

from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from usmbench.runs.record import Column, Record
from usmbench.runs.time_step import breaks

COOLED_S: Final = 3600.0
"""A pause after which a motor is as cold as new: of warmth that fades with 1000 s, 3 % are left."""


def resumes_at_s(stopped_s: float, meta: Mapping[str, Any], least_s: float) -> float:
    """Return the `t_s` at which a run that is taken up now goes on.

    Parameters
    ----------
    stopped_s
        End of the last window, 0 where there is none.
    meta
        What run.yaml says, with when the run started and was taken up again.
    least_s
        The shortest pause: where the wall clock was set back, or a simulated run is ahead of it.
    """
    if stopped_s == 0.0:
        return 0.0
    return max(stopped_s + least_s, _since_started_s(meta))


def _since_started_s(meta: Mapping[str, Any]) -> float:
    """Return how long after its start a run was taken up again last, 0 where nobody knows."""
    try:
        started, resumed = (
            datetime.fromisoformat(str(moment)) for moment in (meta["started"], meta["resumed"][-1])
        )
        return (resumed - started).total_seconds()
    except (LookupError, TypeError, ValueError):
        return 0.0


def cold_starts(record: Record, fewest: int) -> list[Record]:
    """Return the parts of a run whose motor began cold, each with a time of its own.

    Parameters
    ----------
    record
        The run.
    fewest
        Shorter parts are left out, unless all are.

    Returns
    -------
    list of Record
        Named by when they begin, without pairs; a run without such a pause as it is.
    """
    parts = np.split(np.arange(record.t_s.size), _cooled(record.t_s))
    long = [rows for rows in parts if rows.size >= fewest]
    if len(parts) == 1 or not long:
        return [record]
    first, *later = (_part(record, rows) for rows in long)
    # Files that changed are the run's: one part tells of them.
    return [first, *(replace(part, changed=()) for part in later)]


def without_pauses_s(t_s: Column, window_s: float) -> Column:
    """Return the time as if each window began where the one before it ended.

    Parameters
    ----------
    t_s
        End of each window, rising, shape (N,).
    window_s
        Duration of a window.
    """
    left_out_s = np.zeros(t_s.size)
    rows = breaks(t_s, window_s)
    left_out_s[rows] = t_s[rows] - t_s[rows - 1] - window_s
    return np.asarray(t_s - np.cumsum(left_out_s))


def _cooled(t_s: Column) -> NDArray[np.intp]:
    """Return the rows before which the motor has cooled."""
    return np.flatnonzero(np.diff(t_s) >= COOLED_S) + 1


def _part(record: Record, rows: NDArray[np.int64]) -> Record:
    """Return some rows of a run as one that began with them."""
    part = replace(record.rows(rows), pairs=None)
    if rows[0] == 0:
        return part
    begin_s = float(part.t_s[0] - part.window_s[0])
    # The run's id is the first part's.
    meta = {key: value for key, value in record.meta.items() if key != "id"}
    name = f"{record.name} from {begin_s:.0f} s"
    return replace(part, name=name, t_s=part.t_s - begin_s, meta=meta)
