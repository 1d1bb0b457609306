"""What a sweep produces: a row a window, a pair a dwell, and where they go."""

from dataclasses import dataclass
from typing import Protocol

from usmbench.instruments.samples import SampleBlock


@dataclass(frozen=True, slots=True)
class WindowRow:
    """One row of windows.csv; names and units as in the run folder.

    Parameters
    ----------
    t_s
        End of the window, from the first sample of the run.
    phase_deg
        Phase commanded, in force at the end of the window.
    speed_rad_s
        Speed over the window, by the estimator the bench file chose.
    frequency_hz, torque_nm
        Drive frequency and load torque commanded.
    angle_rad
        Unwrapped shaft angle at the window's end.
    window_s
        Duration of the window.
    sweep
        Number of the pass, from 0; -1 before the first (warm-up).
    settled
        1 where the window counts for the dwell's pair.
    average_rad_s
        The paper's last-minus-first speed of the same samples.
    drive_on
        1 while the outputs are on.
    temperature_c
        Temperature, or None without a sensor.
    """

    t_s: float
    phase_deg: float
    speed_rad_s: float
    frequency_hz: float
    torque_nm: float
    angle_rad: float
    window_s: float
    sweep: int
    settled: int
    average_rad_s: float
    drive_on: int
    temperature_c: float | None = None


@dataclass(frozen=True, slots=True)
class PairRow:
    """One row of pairs.csv; names and units as in the run folder.

    Parameters
    ----------
    phase_deg, frequency_hz, torque_nm
        What was commanded.
    speed_rad_s, speed_std_rad_s
        Mean and standard deviation over the settled windows.
    n_windows
        Number of settled windows.
    direction
        +1 where φ was rising, -1 where it was falling.
    t_s
        End of the dwell.
    dwell
        Number of the dwell in the plan, from 0: where a resumed run takes up.
    settled
        1 where the dwell met its settling criterion, 0 where it ran out of windows first.
    """

    phase_deg: float
    frequency_hz: float
    torque_nm: float
    speed_rad_s: float
    speed_std_rad_s: float
    n_windows: int
    direction: int
    t_s: float
    dwell: int
    settled: int


class Sink(Protocol):
    """Where a sweep's results go; the run folder's writer is one."""

    def window(self, row: WindowRow) -> None:
        """Keep one window."""

    def pair(self, row: PairRow) -> None:
        """Keep one pair, and have everything so far forced to disk."""

    def raw(self, block: SampleBlock) -> None:
        """Keep a block's samples, where raw samples were asked for."""
