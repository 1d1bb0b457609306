"""Where the shaft stands between two encoder edges, from when the last edges fell.

Position is counted in whole counts: counter value p says that the shaft lies between boundaries
p and p + 1. An edge between samples k - 1 and k is the crossing of a known boundary at
k - 1/2 ± 1/2 samples: in position exact, in time uniform over one sample. So time is fitted as a
polynomial in position over the last edges, and asked when the next boundary is due.

The smoothest polynomial is taken that passes through the sampling interval of every edge it uses:
a long straight line at constant speed, where it averages the sampling error out, a short parabola
or the last two edges alone where the speed changes, so that older motion does not bias this window.
"""

from functools import cache
from math import sqrt

import numpy as np
from numpy.typing import NDArray

EDGES_KEPT = 16
# (edges, degree), smoothest first; the last one passes through its edges whatever they are.
_LADDER = ((EDGES_KEPT, 1), (8, 2), (4, 2), (2, 1))
# An edge lies within half a sample of its time stamp; the fit itself is off by a part of that.
_RESIDUAL_MAX_SAMPLES = 0.6


@cache
def _least_squares(n_edges: int, degree: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the basis (n, d + 1) on edges 1 - n … 0 and its pseudo-inverse (d + 1, n)."""
    basis = np.vander(np.arange(1.0 - n_edges, 1.0), degree + 1, increasing=True)
    return basis, np.linalg.pinv(basis)


def _fit(since_last: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return c0, c1, c2 of time = c0 + c1 s + c2 s², s counts after the last edge."""
    previous = None
    for n_edges, degree in _LADDER:
        n_used = min(n_edges, len(since_last))
        if n_used <= degree or (n_used, degree) == previous:
            continue
        previous = n_used, degree
        times = since_last[-n_used:]
        basis, inverse = _least_squares(n_used, degree)
        coefficients = inverse @ times
        residual = basis @ coefficients
        residual -= times
        if max(residual.max(), -residual.min()) <= _RESIDUAL_MAX_SAMPLES:
            break
    c0, c1, *rest = coefficients.tolist()
    return c0, c1, rest[0] if rest else 0.0


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
