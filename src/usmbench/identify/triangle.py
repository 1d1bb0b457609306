"""Rows of a least-squares problem reduced to the triangle that says the same."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def triangle(rows: Array) -> Array:
    """Return the triangular factor R of ``rows = Q R``.

    Rows of several blocks can be reduced block by block and their triangles stacked and reduced
    again (the tall-skinny QR of Demmel et al. 2012, doi:10.1137/080731992): the same result at
    any size, without squaring the condition as the normal equations do.

    Parameters
    ----------
    rows
        Regressors, and outcomes as further columns, shape (n, m).

    Returns
    -------
    Array
        Shape (min(n, m), m).
    """
    return np.asarray(np.linalg.qr(rows, mode="r"), dtype=np.float64)


def full_rank(rows: Array) -> Array:
    """Return the triangular factor with a trace of a prior on what the rows do not resolve.

    Parameters
    ----------
    rows
        Regressors, shape (n, m).

    Returns
    -------
    Array
        Shape (m, m), with no zero on its diagonal.
    """
    factor = triangle(rows)
    trace = 1e-10 * max(float(np.abs(factor).max()), 1e-300) * np.eye(factor.shape[1])
    return triangle(np.vstack([factor, trace]))
