"""Where the shaft stands between two encoder edges, from when the last edges fell.

Position is counted in whole counts: counter value p says that the shaft lies between boundaries
p and p + 1. An edge between samples k - 1 and k is the crossing of a known boundary at
k - 1/2 ± 1/2 samples: in position exact, in time uniform over one sample. So time is fitted as a
polynomial in position over the last edges, and asked when the next boundary is due.

The smoothest polynomial is taken that leaves no more than the sampling error: a long straight line
at constant speed, where that error averages out, a short parabola or the last two edges alone where
the speed changes, so that older motion does not bias this window.
"""

from functools import cache
from math import sqrt

import numpy as np
from numpy.typing import NDArray

EDGES_KEPT = 48
# (edges, degree), smoothest first; where none fits, the last two edges alone tell the speed.
_LADDER = ((EDGES_KEPT, 1), (8, 2), (4, 2))
# Time stamps are off by up to half a sample, 1/12 in mean square; fits up to this many times
# worse are taken to be the sampling, worse ones the motion.
_MISFIT_MAX = 1.8


@cache
def _least_squares(n_edges: int, degree: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return what makes coefficients (d + 1) and residuals (n) of the times of edges 1 - n … 0."""
    basis = np.vander(np.arange(1.0 - n_edges, 1.0), degree + 1, increasing=True)
    coefficients = np.linalg.pinv(basis)
    return coefficients, basis @ coefficients - np.eye(n_edges)


def _fit(since_last: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return c0, c1, c2 of time = c0 + c1 s + c2 s², s counts after the last edge."""
    for n_edges, degree in _LADDER:
        times = since_last[-n_edges:]
        spare = len(times) - degree - 1
        if spare <= 0:
            continue
        coefficients, residuals = _least_squares(len(times), degree)
        residual = residuals @ times
        if residual @ residual <= _MISFIT_MAX / 12.0 * spare:
            c0, c1, *c2 = (coefficients @ times).tolist()
            return c0, c1, c2[0] if c2 else 0.0
    return 0.0, float(since_last[-1] - since_last[-2]), 0.0


def fraction_passed(edge_samples: NDArray[np.float64], sample: float) -> float:
    """Return how far the shaft has come from the last edge towards the next boundary.

    Parameters
    ----------
    edge_samples
        Times of the last edges crossed in one direction, one count apart, oldest first, in samples,
        shape (E,).
    sample
        Time asked for, in samples, not before the last edge.

    Returns
    -------
    float
        0 at the last edge, 1 at the next boundary, where it stays when the next edge is overdue.
        0 as well when a single edge is known, which tells no speed.
    """
    if len(edge_samples) < 2:
        return 0.0
    last = edge_samples[-1]
    c0, c1, c2 = _fit(edge_samples - last)
    elapsed = float(sample - last) - c0
    if elapsed <= 0.0:
        return 0.0
    discriminant = c1 * c1 + 4.0 * c2 * elapsed
    if c1 <= 0.0 or discriminant < 0.0:
        return 1.0
    return min(1.0, 2.0 * elapsed / (c1 + sqrt(discriminant)))
