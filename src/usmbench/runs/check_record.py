"""Runs that no command can take, or not together, refused in one way; or doubted, in one way."""

from collections.abc import Sequence
from hashlib import sha256

import numpy as np

from usmbench.errors import InputError
from usmbench.runs.record import Record

_COLUMNS = ("t_s", "phase_deg", "speed_rad_s", "frequency_hz", "torque_nm", "angle_rad")
BEYOND_MEASURE = 1e12  # in whatever unit: no bench has measured as much


def check_numbers(record: Record) -> None:
    """Refuse a run without rows, what is no number, and a time before the first sample.

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
        known = np.abs(column) < BEYOND_MEASURE
        if not np.all(known):
            row = int(np.argmin(known))
            raise InputError(
                f"{record.name}: {name} of row {row} is {column[row]}; remove the row or mend it"
            )
    if record.t_s[0] < 0.0:
        raise InputError(
            f"{record.name}: t_s begins at {record.t_s[0]:g} s; count it from the first sample"
        )


def check_together(records: Sequence[Record]) -> None:
    """Refuse runs of different motors or encoders, and a run that is given twice.

    Parameters
    ----------
    records
        The runs.

    Raises
    ------
    usmbench.errors.InputError
        They name more than one motor, or encoders of different counts per revolution; or two have
        one id, or the same rows and not an id each.
    """
    motors = {r.motor: f"{r.name} is of {r.motor}" for r in records if r.motor is not None}
    # Counts that are lost, and teeth that lean, are those of one disc.
    encoders = {
        r.counts_per_rev: f"{r.name} has {r.counts_per_rev:.12g} counts per revolution"
        for r in records
        if r.counts_per_rev is not None
    }
    for said, one in ((motors.values(), "motor"), (encoders.values(), "encoder")):
        if len(said) > 1:
            raise InputError(
                f"these runs do not belong together: {'; '.join(said)}; take one {one} at a time"
            )
    by_id: dict[str, Record] = {}
    by_rows: dict[bytes, Record] = {}
    for record in records:
        identity, rows = record.meta.get("id"), _sum_of_rows(record)
        same = None if identity is None else by_id.get(str(identity))
        alike = by_rows.get(rows)
        # Of a bare CSV nothing but its rows tells which run it is.
        if alike is not None and None in (identity, alike.meta.get("id")):
            same = alike
        if same is not None:
            raise InputError(f"{record.name}: is the same run as {same.name}; give each run once")
        by_rows[rows] = record
        if identity is not None:
            by_id[str(identity)] = record


def _sum_of_rows(record: Record) -> bytes:
    """Return a check sum of what was commanded and measured."""
    columns = (record.phase_deg, record.speed_rad_s, record.frequency_hz, record.torque_nm)
    return sha256(np.column_stack([c for c in columns if c is not None]).tobytes()).digest()


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
