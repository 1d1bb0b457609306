"""Rows of a least-squares problem reduced to the triangle that says the same."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgeqrf

Array = NDArray[np.float64]

_BLOCK_ROWS = 512  # a block stays in the cache
_PANEL = 32  # columns that LAPACK may treat at a time


def triangle(*blocks: Array) -> Array:
    """Return the triangular factor R of ``rows = Q R``.

    Rows are reduced block by block, and the blocks' triangles stacked and reduced again (the
    tall-skinny QR of Demmel et al. 2012, doi:10.1137/080731992): the same result at any size,
    without squaring the condition as the normal equations do.

    Parameters
    ----------
    *blocks
        Rows of regressors, and outcomes as further columns, shape (n_k, m) each.

    Returns
    -------
    Array
        Shape (min(Σ n_k, m), m).
    """
    short = [part for block in blocks for part in _shortened(block)]
    return _factor(short[0] if len(short) == 1 else np.vstack(short))


def _shortened(block: Array) -> list[Array]:
    """Triangles of parts of a block that say the same; the block itself where it is no taller."""
    n, m = block.shape
    height = max(_BLOCK_ROWS, 4 * m)
    if n <= 2 * m:
        return [block]
    return [_factor(block[first : first + height]) for first in range(0, n, height)]


def _factor(rows: Array) -> Array:
    """Triangular factor of a few rows, by Householder reflections."""
    n, m = rows.shape
    if n == 0:
        return rows
    packed = dgeqrf(rows, lwork=_PANEL * m)[0]
    return np.asarray(np.triu(packed[: min(n, m)]), dtype=np.float64)


def full_rank(*blocks: Array) -> Array:
    """Return the triangular factor with a trace of a prior on what the rows do not resolve.

    Parameters
    ----------
    *blocks
        Rows of regressors, shape (n_k, m) each.

    Returns
    -------
    Array
        Shape (m, m), with no zero on its diagonal.
    """
    factor = triangle(*blocks)
    trace = 1e-10 * max(float(np.abs(factor).max()), 1e-300) * np.eye(factor.shape[1])
    return triangle(factor, trace)
