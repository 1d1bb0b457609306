"""The commands of a run as a schedule, to be driven again."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.runs.dwells import directions
from usmbench.runs.record import Column, Record
from usmbench.settings.plan import USUAL_FREQUENCY_HZ, Settle
from usmbench.settings.plan_file import operator_sets_load
from usmbench.sweep.schedule import HOLD_SETTLE, WARM_UP, Dwell

DEFAULT_TORQUE_NM = 0.0  # of a run without the column


def recorded_dwells(record: Record, window_s: float) -> list[Dwell]:
    """Return the dwells of a run: stretches of driven windows with the same command.

    Parameters
    ----------
    record
        The run. Rows without drive are left out; the sweep rests by itself before and after.
    window_s
        Duration of a window on the bench that is to drive them; each dwell keeps its duration.

    Raises
    ------
    usmbench.errors.InputError
        No row of the run was driven.
    """
    rows = np.flatnonzero(np.ones(record.t_s.size) if record.driven is None else record.driven)
    if rows.size == 0:
        raise InputError("no window was driven; there is nothing to replay", file=record.name)
    dwells: list[Dwell] = []
    stretches = np.split(rows, _changes(record, rows))
    firsts = np.array([stretch[0] for stretch in stretches])
    passes = None if record.sweep is None else record.sweep[firsts]
    ways = directions(record.phase_deg[firsts], passes)
    for stretch, direction in zip(stretches, ways.tolist(), strict=True):
        first = int(stretch[0])
        windows = max(1, round(float(record.window_s[stretch].sum()) / window_s))
        sweep = 0 if record.sweep is None else int(record.sweep[first])
        dwells.append(
            Dwell(
                number=len(dwells) if sweep >= 0 else WARM_UP,
                sweep=sweep,
                phase_deg=float(record.phase_deg[first]),
                frequency_hz=_at(record.frequency_hz, first, USUAL_FREQUENCY_HZ),
                torque_nm=_at(record.torque_nm, first, DEFAULT_TORQUE_NM),
                direction=int(direction),
                windows=windows,
                extend_to_windows=windows,
                settle=_settle(windows) if sweep >= 0 else None,
            )
        )
    return dwells


def operator_set_loads(record: Record, dwells: Iterable[Dwell]) -> bool:
    """Return whether somebody set the loads of a run, as its plan says or several torques show.

    Parameters
    ----------
    record
        The run.
    dwells
        Its dwells.
    """
    plan = record.meta.get("plan")
    by_plan = isinstance(plan, dict) and operator_sets_load(plan)
    return by_plan or len({dwell.torque_nm for dwell in dwells}) > 1


def _changes(record: Record, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return where among the driven rows another command begins."""
    changed = np.diff(rows) > 1
    for column in (record.phase_deg, record.frequency_hz, record.torque_nm, record.sweep):
        if column is not None:
            changed |= np.diff(column[rows]) != 0.0
    return np.asarray(np.flatnonzero(changed) + 1)


def _at(column: Column | None, row: int, otherwise: float) -> float:
    return otherwise if column is None else float(column[row])


def _settle(windows: int) -> Settle | None:
    """Return the criterion that a dwell of this length can meet."""
    usual = Settle()
    if windows > usual.min_windows + usual.over_windows:
        return usual
    return HOLD_SETTLE if windows > HOLD_SETTLE.min_windows else None
