"""Drive frequency and load of runs that do not say them, beside runs that do."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from usmbench.runs.record import Record

_UNITS = {"frequency_hz": "Hz", "torque_nm": "N·m"}


def as_the_others(records: Sequence[Record]) -> tuple[list[Record], list[str]]:
    """Take a run that has no column of frequency or torque for one at that of the others.

    A column that is missing is not said, and no other operating point. Where the others are at
    several, nothing tells which; the run is then left a point of its own.

    Parameters
    ----------
    records
        The runs, at least one.

    Returns
    -------
    tuple of list and list
        The runs, and what the user ought to know of them.
    """
    found, warnings = list(records), []
    for name, unit in _UNITS.items():
        said = [c for r in records if (c := getattr(r, name)) is not None]
        if len(said) in (0, len(records)):
            continue
        values = np.unique(np.concatenate(said))
        one = values.size == 1 and np.isfinite(values[0])
        for k, record in enumerate(found):
            if getattr(record, name) is not None:
                continue
            if one:
                column: dict[str, Any] = {name: np.full(record.t_s.size, values[0])}
                found[k] = replace(record, **column)
                taken = f"taken for {values[0]:.12g} {unit}, as in the others"
            else:
                taken = "the others are at several, so that it is an operating point of its own"
            warnings.append(f"{record.name}: no column {name}: {taken}")
    return found, warnings
