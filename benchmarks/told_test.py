"""The test that is told what a mechanism does to every window, and only has to find its size."""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from benchmarks.campaign_sizes import square_of
from usmbench.diagnose.naming.found import Found
from usmbench.runs.record import Record

_ALARM: Final = 0.05
LENGTH: Final = float(norm.isf(0.5 * _ALARM) + norm.isf(0.1))
"""Of a whitened effect that the test finds in 90 % of runs, at 5 % false alarms."""


def told_length(
    effects_rad_s: NDArray[np.float64],
    record: Record,
    found: Found,
    told: NDArray[np.bool_] | None = None,
) -> float:
    """Return the length of an effect, whitened by what diagnose knows of the run and the model.

    Parameters
    ----------
    effects_rad_s
        What the mechanism changes in the run's speed, as some days show it, shape (D, N).
    record
        The run.
    found
        What the search came to in it.
    told
        The windows that the test sees, shape (N,); None for all.
    """
    problem = found.problem
    rows = [np.searchsorted(record.t_s, s.context.t_s) for s in problem.stretches]
    if told is not None:
        parts = zip(problem.masks, rows, strict=True)
        problem = problem.with_masks([mask & told[k] for mask, k in parts])
    seen = [problem.carried([effect[k] for k in rows]) for effect in effects_rad_s]
    return float(np.sqrt(square_of(np.stack(seen)))) / found.spread


def told_power(length: float) -> float:
    """Return in which share of runs the test finds an effect of a length, its right way round.

    Parameters
    ----------
    length
        As `told_length` returns it.
    """
    return float(norm.sf(norm.isf(0.5 * _ALARM) - length))
