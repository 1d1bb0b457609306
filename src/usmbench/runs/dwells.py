"""Settled (φ, ω) pairs from windows, where a run has no pairs.csv."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from usmbench.runs.columns import DRIVE_COLUMN
from usmbench.runs.record import Column, Pairs

# Without a settled column: the part of a dwell taken for settling, whatever its length.
_SETTLING_SHARE = 1.0 / 3.0


def derive_pairs(
    t_s: Column,
    phase_deg: Column,
    speed_rad_s: Column,
    optional: Mapping[str, Column | None],
) -> Pairs | None:
    """Average the settled windows of every dwell.

    A dwell is a stretch of windows with the same phase, frequency, torque, sweep and drive; one
    without drive, or of a warm-up, has no pair.

    Parameters
    ----------
    t_s, phase_deg, speed_rad_s
        Columns of the windows, shape (N,).
    optional
        The columns frequency_hz, torque_nm, sweep, settled and drive_on, each shape (N,) or None.
        Without `settled` the first third of each dwell is left out.

    Returns
    -------
    Pairs or None
        One pair a dwell that has settled windows; frequency and torque are NaN where the run does
        not say. None where no dwell has any.
    """
    unknown = np.full(len(t_s), np.nan)
    frequency_hz = _or(optional.get("frequency_hz"), unknown)
    torque_nm = _or(optional.get("torque_nm"), unknown)
    sweep, drive_on = optional.get("sweep"), optional.get(DRIVE_COLUMN)
    commands = [phase_deg, frequency_hz, torque_nm, _or(sweep, unknown), _or(drive_on, unknown)]
    first = np.zeros(len(t_s), dtype=bool)
    first[0] = True
    for command in commands:
        first[1:] |= (command[1:] != command[:-1]) & ~np.isnan(command[1:])
    start = np.flatnonzero(first)
    length = np.diff(np.append(start, len(t_s)))
    settled = optional.get("settled")
    if settled is None:
        into_dwell = np.arange(len(t_s)) - np.repeat(start, length)
        counted = into_dwell >= np.repeat(np.floor(length * _SETTLING_SHARE), length)
    else:
        counted = settled != 0.0
    if sweep is not None:
        counted &= sweep >= 0.0
    if drive_on is not None:
        counted &= drive_on != 0.0
    n_windows = np.add.reduceat(counted, start, dtype=np.float64)
    has_pair = n_windows > 0.0
    if not has_pair.any():
        return None
    divisor = np.maximum(n_windows, 1.0)
    mean = np.add.reduceat(np.where(counted, speed_rad_s, 0.0), start) / divisor
    deviation = np.where(counted, speed_rad_s - np.repeat(mean, length), 0.0)
    # One degree of freedom goes into the mean.
    variance = np.add.reduceat(deviation**2, start) / np.maximum(n_windows - 1.0, 1.0)
    return Pairs(
        phase_deg=phase_deg[start][has_pair],
        frequency_hz=frequency_hz[start][has_pair],
        torque_nm=torque_nm[start][has_pair],
        speed_rad_s=mean[has_pair],
        speed_std_rad_s=np.sqrt(variance)[has_pair],
        n_windows=n_windows[has_pair],
        direction=directions(phase_deg[start], None if sweep is None else sweep[start])[has_pair],
        t_s=t_s[start + length - 1][has_pair],
    )


def dwell_begin(*commands: Column) -> NDArray[np.int64]:
    """Return the row at which the last command was given that holds in each row, shape (N,).

    Parameters
    ----------
    *commands
        What was commanded, the phase and whatever else, at least one, shape (N,) each.
    """
    rows = np.arange(commands[0].size)
    changed = np.any([np.diff(c, prepend=c[:1]) != 0.0 for c in commands], axis=0)
    begin: NDArray[np.int64] = np.maximum.accumulate(np.where(changed, rows, 0))
    return begin


def _or(column: Column | None, otherwise: Column) -> Column:
    """Return the column, or what stands for it where there is none."""
    return otherwise if column is None else column


def directions(phase_deg: Column, sweep: Column | None) -> Column:
    """Return +1 where φ rose to a dwell and -1 where it fell; a pass begins as it goes on.

    Parameters
    ----------
    phase_deg
        Phase of each dwell, in the order driven, shape (D,).
    sweep
        Number of its pass, shape (D,), which a warm-up may interrupt; None where nobody knows.
    """
    passes = np.zeros(phase_deg.size) if sweep is None else sweep
    direction = np.ones(phase_deg.size)
    order = np.argsort(passes, kind="stable")
    begins = np.flatnonzero(np.diff(passes[order])) + 1
    for rows in np.split(order, begins):
        direction[rows] = _in_pass(phase_deg[rows])
    return direction


def _in_pass(phase_deg: Column) -> Column:
    """Return the directions within a pass; a start or repeat looks beyond."""
    step = np.sign(np.diff(phase_deg, prepend=phase_deg[0]))
    moved = np.flatnonzero(step)
    if not len(moved):
        return np.ones(len(phase_deg))
    latest = np.maximum.accumulate(np.where(step != 0.0, np.arange(len(step)), moved[0]))
    direction: Column = step[latest]
    return direction
