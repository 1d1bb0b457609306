"""Where an experiment may go: phases, frequencies and torques that the model knows."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

Array = NDArray[np.float64]

_DEAD_ZONE_DEG = (-5.0, 5.0)  # where the model knows of none


@dataclass(frozen=True, slots=True)
class Range:
    """Where an experiment may go.

    Parameters
    ----------
    low_deg, high_deg
        Lowest and highest phase.
    dead_zone_deg
        Lower and upper edge of the dead zone.
    window_s
        Duration of a window.
    frequency_hz, torque_nm
        Drive frequencies and load torques that the model knows, at least one each; where the runs
        were comes first.
    """

    low_deg: float
    high_deg: float
    dead_zone_deg: tuple[float, float]
    window_s: float
    frequency_hz: tuple[float, ...]
    torque_nm: tuple[float, ...]


def range_of(model: HammersteinModel, records: Sequence[Record]) -> Range | None:
    """Return where a model may be used; None where no drive frequency is known.

    Parameters
    ----------
    model
        The model.
    records
        Runs of the motor: what they drove comes first.
    """
    points = model.points
    frequencies_hz = _known((p.frequency_hz for p in points), [r.frequency_hz for r in records])
    if not frequencies_hz:
        return None
    low_deg = max(p.phase_range_deg[0] for p in points)
    high_deg = min(p.phase_range_deg[1] for p in points)
    zone = points[0].dead_zone_deg
    edges = tuple(
        default if edge is None else edge
        for edge, default in zip(zone, _DEAD_ZONE_DEG, strict=True)
    )
    return Range(
        low_deg,
        high_deg,
        (edges[0], edges[1]),
        records[0].usual_window_s,
        frequencies_hz,
        _known((p.torque_nm for p in points), [r.torque_nm for r in records]) or (0.0,),
    )


def _known(values: Iterable[float | None], columns: Sequence[Array | None]) -> tuple[float, ...]:
    """Return what the points know of a setting, nearest to the runs' first; else the runs' own."""
    known = sorted({value for value in values if value is not None})
    driven = [float(np.median(column)) for column in columns if column is not None]
    if not driven:
        return tuple(known)
    return tuple(sorted(known, key=lambda value: abs(value - driven[0]))) or (driven[0],)
