"""A run in memory: columns of equal length, as every command after the sweep takes them."""

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from usmbench.runs.columns import DRIVE_COLUMN
from usmbench.runs.meta import said_motor

Column = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Pairs:
    """Settled (φ, ω) pairs, one a dwell; every column has shape (P,).

    Parameters
    ----------
    phase_deg, frequency_hz, torque_nm
        What was commanded.
    speed_rad_s, speed_std_rad_s
        Mean and standard deviation over the settled windows of the dwell.
    n_windows
        Number of those windows.
    direction
        +1 where φ was rising, -1 where it was falling.
    t_s
        End of the dwell, from the first sample of the run.
    """

    phase_deg: Column
    frequency_hz: Column
    torque_nm: Column
    speed_rad_s: Column
    speed_std_rad_s: Column
    n_windows: Column
    direction: Column
    t_s: Column


@dataclass(frozen=True, slots=True)
class Record:
    """One run; every column has shape (N,), one entry a window.

    Parameters
    ----------
    name
        Folder or file the run was read from, for messages.
    t_s
        End of each window, from the first sample of the run; strictly rising.
    phase_deg
        Phase commanded, in force at the end of the window.
    speed_rad_s
        Speed averaged over the window.
    window_s
        Duration of each window.
    frequency_hz, torque_nm, angle_rad, sweep, settled, temperature_c
        As in the run folder; None where the run does not have the column.
    pairs
        The settled pairs, measured or derived from the windows.
    meta
        What run.yaml says; empty for a bare CSV.
    extra
        Every other column by its name, as numbers where it holds nothing else, else as text.
    changed
        Files the run was read from that are not what they were when it was closed.
    """

    name: str
    t_s: Column
    phase_deg: Column
    speed_rad_s: Column
    window_s: Column
    frequency_hz: Column | None = None
    torque_nm: Column | None = None
    angle_rad: Column | None = None
    sweep: Column | None = None
    settled: Column | None = None
    temperature_c: Column | None = None
    pairs: Pairs | None = None
    meta: dict[str, Any] = field(default_factory=dict)
    extra: dict[str, Column | NDArray[np.str_]] = field(default_factory=dict)
    changed: tuple[str, ...] = ()

    @property
    def usual_window_s(self) -> float:
        """Duration of a window: the mean of those near the median, which no pause moves.

        The median of durations that jitter by a tenth is off by half a hundredth.
        """
        middle_s = float(np.median(self.window_s))
        off_s = self.window_s - middle_s
        return middle_s + float(np.mean(off_s[np.abs(off_s) <= 0.5 * middle_s]))

    @property
    def motor(self) -> str | None:
        """Name of the motor; None where run.yaml does not say."""
        return said_motor(self.meta)

    @property
    def counts_per_rev(self) -> float | None:
        """Counts of one revolution of the encoder; None where run.yaml does not say."""
        counts: float | None = (self.meta.get("encoder") or {}).get("counts_per_rev")
        return counts

    @property
    def count_rad(self) -> float | None:
        """Angle of one count; None where run.yaml does not say how many a revolution has."""
        counts = self.counts_per_rev
        return None if counts is None else 2.0 * math.pi / counts

    @property
    def driven(self) -> NDArray[np.bool_] | None:
        """Which windows the motor was driven in, shape (N,); None where the run does not say."""
        drive_on = self.extra.get(DRIVE_COLUMN)
        return None if drive_on is None else np.asarray(drive_on.astype(np.float64) != 0.0)

    @property
    def phase_step_deg(self) -> float | None:
        """Step of the phases that the generator sets; None where run.yaml does not say."""
        generator = self.meta.get("generator")
        step_deg = generator.get("phase_step_deg") if isinstance(generator, dict) else None
        return None if step_deg is None else float(step_deg)

    def rows(self, rows: NDArray[np.bool_] | NDArray[np.integer[Any]]) -> Self:
        """Return the run with some of its rows.

        Parameters
        ----------
        rows
            Which, a mask of shape (N,) or their numbers. The pairs stay.
        """
        changes: dict[str, Any] = {
            own.name: column[rows]
            for own in fields(self)
            if isinstance(column := getattr(self, own.name), np.ndarray)
        }
        changes["extra"] = {name: column[rows] for name, column in self.extra.items()}
        return replace(self, **changes)
