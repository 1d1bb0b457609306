"""What warms the motor in a run, and what it may have been where its log has gaps."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.tabled_curve import NODES_DEG
from usmbench.diagnose.cutting.warmth import warmth
from usmbench.identify.wild_rows import wild_rows
from usmbench.model.driving import in_gaps
from usmbench.runs.record import Record
from usmbench.runs.time_step import breaks

Array = NDArray[np.float64]


def heating(
    record: Record,
    weights: Sequence[Array],
    speeds: Sequence[Array],
    pieces: Sequence[NDArray[np.int64]],
) -> list[tuple[Array, Array | None]]:
    """Return how warm a run has made the motor.

    Parameters
    ----------
    record
        The run.
    weights
        Weight of each of the model's operating points in each window, shape (N,) each.
    speeds
        Speed of each point at `NODES_DEG`.
    pieces
        Rows that are asked for.

    Returns
    -------
    list of (Array, Array or None)
        `Stretch.warmth` and `Stretch.unsure_warmth` of each piece.
    """
    window_s, powers = record.usual_window_s, _powers(record, weights, speeds)
    rows = breaks(record.t_s, window_s)
    share = in_gaps(record.t_s, rows, record.driven)
    met = [share * power[rows] for power in powers]
    warm = warmth(record.t_s, window_s, powers, met, pieces)
    unknown = (share > 0.0) & (share < 1.0)
    if not unknown.any():
        return [(warmed, None) for warmed in warm]
    off = [np.where(unknown, power, 0.0) for power in met]
    none = [np.zeros_like(power) for power in powers]
    unsure = warmth(record.t_s, window_s, none, off, pieces)
    return list(zip(warm, unsure, strict=True))


def _powers(record: Record, weights: Sequence[Array], speeds: Sequence[Array]) -> list[Array]:
    """Return what may warm the motor, in the order of `Stretch.warmth`, shape (N,) each."""
    first, last = np.searchsorted(NODES_DEG, (record.phase_deg.min(), record.phase_deg.max()))
    tops = [float(np.max(np.abs(speed[first : last + 1]))) for speed in speeds]
    # What no motor turns at has not warmed one.
    size = np.where(wild_rows(record), 0.0, np.abs(record.speed_rad_s))
    highest = np.asarray(tops) @ np.asarray(weights)
    on = np.ones(size.size) if record.driven is None else record.driven.astype(np.float64)
    return [on, on * size, on * highest**2]
