"""Runs that no command can take, or not together, refused in one way; or doubted, in one way."""

from collections.abc import Sequence

import numpy as np

from usmbench.errors import InputError
from usmbench.runs.record import Record

_COLUMNS = ("t_s", "phase_deg", "speed_rad_s", "frequency_hz", "torque_nm", "angle_rad")
_BEYOND = 1e12  # in whatever unit: no bench has measured as much


def check_numbers(record: Record) -> None:
    """Refuse a run without rows, and what is no number in what was commanded or measured.

    Parameters
    ----------
    record
        The run.

    Raises
    ------
    usmbench.errors.InputError
        The run is one of these; the message names the row.
    """
    if record.t_s.size == 0:
        raise InputError(f"{record.name}: there is no row")
    for name in _COLUMNS:
        column = getattr(record, name)
        if column is None:
            continue
        known = np.abs(column) < _BEYOND
        if not np.all(known):
            row = int(np.argmin(known))
            raise InputError(
                f"{record.name}: {name} of row {row} is {column[row]}; remove the row or mend it"
            )


def check_together(records: Sequence[Record]) -> None:
    """Refuse runs of different motors, and a run that is given twice.

    Parameters
    ----------
    records
        The runs.

    Raises
    ------
    usmbench.errors.InputError
        They name more than one motor, or have one id.
    """
    motors = {str(r.meta["motor"]): r.name for r in records if r.meta.get("motor") is not None}
    if len(motors) > 1:
        said = "; ".join(f"{name} is of {motor}" for motor, name in motors.items())
        raise InputError(f"these runs do not belong together: {said}; take one motor at a time")
    seen: dict[str, str] = {}
    for record in records:
        identity = record.meta.get("id")
        if identity is not None and str(identity) in seen:
            raise InputError(
                f"{record.name}: is the same run as {seen[str(identity)]}; give each run once"
            )
        seen[str(identity)] = record.name


def changed_since_closed(records: Sequence[Record]) -> list[str]:
    """Warn of runs whose data are not what they were when the run was closed.

    They may have been mended by hand: they are taken as they are now.

    Parameters
    ----------
    records
        The runs.
    """
    return [
        f"{record.name}: {' and '.join(record.changed)} changed after the run was closed, by the "
        "check sums in its run.yaml; taken as it is now, restore it from a copy if nobody meant it"
        for record in records
        if record.changed
    ]
