"""How warm a run has made the motor: powers, each through a set of thermal time constants.

A stator and its housing are heat capacities in a row; each node's temperature is a sum of such
responses, and a change of speed that goes by temperature is one, too. Constants half a decade apart
leave of any from half a minute on no more than some thousandths.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.model.lagged import lagged
from usmbench.runs.time_step import breaks

Array = NDArray[np.float64]

TIME_CONSTANTS_S = (10.0, 32.0, 100.0, 316.0, 1000.0)


def n_constants(lasts_s: float) -> int:
    """Return how many of the constants runs tell apart: those shorter than they last, and one more.

    Parameters
    ----------
    lasts_s
        For how long the longest of them drives the motor.
    """
    return min(int(np.searchsorted(TIME_CONSTANTS_S, lasts_s)) + 1, len(TIME_CONSTANTS_S))


def warmth(
    t_s: Array,
    window_s: float,
    powers: Sequence[Array],
    in_gaps: Sequence[Array],
    pieces: Sequence[NDArray[np.int64]],
) -> list[Array]:
    """Return what each power has warmed so far, cold at the start of the run.

    Parameters
    ----------
    t_s
        End of every window of a run, rising, shape (N,).
    window_s
        Length of a window.
    powers
        Powers in each window, shape (N,) each.
    in_gaps
        The same in each gap of the time, shape (K,) each.
    pieces
        Rows that are asked for.

    Returns
    -------
    list of Array
        One a piece, in the power's unit: what it would be after long at this power, shape (powers,
        `TIME_CONSTANTS_S`, rows).
    """
    found = [np.empty((len(powers), len(TIME_CONSTANTS_S), rows.size)) for rows in pieces]
    parts = np.split(np.arange(t_s.size), breaks(t_s, window_s))
    for p, (power, in_gap) in enumerate(zip(powers, in_gaps, strict=True)):
        # What comes before the first row is as its power.
        before = np.r_[power[0], in_gap]
        for k, constant_s in enumerate(TIME_CONSTANTS_S):
            responses = _through(t_s, window_s, power, before, constant_s, parts)
            warm = np.concatenate(list(responses))
            for piece, rows in zip(found, pieces, strict=True):
                piece[p, k] = warm[rows]
    return found


def _through(
    t_s: Array,
    window_s: float,
    power: Array,
    before: Array,
    constant_s: float,
    parts: Sequence[NDArray[np.int64]],
) -> Iterator[Array]:
    """Yield the response of a first-order lag, a part without a gap each."""
    kept, warm, last_s = np.exp(-window_s / constant_s), 0.0, 0.0
    for rows, in_gap in zip(parts, before, strict=True):
        gap_s = max(float(t_s[rows[0]]) - window_s - last_s, 0.0)
        warm = in_gap + (warm - in_gap) * np.exp(-gap_s / constant_s)
        response = lagged(power[rows], kept, warm)
        yield response
        warm, last_s = float(response[-1]), float(t_s[rows[-1]])
