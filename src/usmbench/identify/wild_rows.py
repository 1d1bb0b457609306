"""Rows of a speed that no motor and no cause of ours makes: one of them is all that a fit sees."""

import numpy as np
from numpy.typing import NDArray

from usmbench.runs.record import Record

Mask = NDArray[np.bool_]

_NEARLY_ALL, WILD_TIMES = 0.99, 5.0  # of the rows; times their speed


def wild_rows(record: Record) -> Mask:
    """Return the rows that are far faster than nearly all that were driven, shape (N,).

    Parameters
    ----------
    record
        The run.
    """
    size, driven = np.abs(record.speed_rad_s), record.driven
    turned = size if driven is None or not driven.any() else size[driven]
    usual = float(np.quantile(turned, _NEARLY_ALL))
    wild: Mask = size > WILD_TIMES * usual if usual > 0.0 else np.zeros(size.size, dtype=np.bool_)
    return wild


def without_wild_rows(record: Record) -> Record:
    """Return a run with a gap in its time where such rows were.

    Parameters
    ----------
    record
        The run.
    """
    kept = ~wild_rows(record)
    return record if kept.all() else record.rows(kept)
