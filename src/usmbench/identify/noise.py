"""Coloured noise: an autoregressive model of what the simulation leaves."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

Array = NDArray[np.float64]

HIGHEST_ORDER = 10


def fit_noise(pieces: Sequence[Array], highest_order: int = HIGHEST_ORDER) -> tuple[Array, float]:
    """Fit an autoregressive model to residuals, its order by Schwarz's criterion.

    Parameters
    ----------
    pieces
        Residuals of unbroken stretches, each of shape (n_k,), of about zero mean.
    highest_order
        Highest order tried.

    Returns
    -------
    coefficients
        c of ``e(t) = Σ c_i e(t−i) + white``, shape (p,); p may be 0.
    white
        Standard deviation of the white part.
    """
    n = sum(piece.size for piece in pieces)
    order = max(0, min(highest_order, n // 20, min(p.size for p in pieces) - 1))
    lags = np.array([sum(float(p[k:] @ p[: p.size - k]) for p in pieces) for k in range(order + 1)])
    covariance = lags / max(n, 1)
    if covariance[0] <= 0.0:
        return np.empty(0), 0.0
    best, least = (np.empty(0), float(covariance[0])), n * np.log(covariance[0])
    for p in range(1, order + 1):
        coefficients = solve_toeplitz(covariance[:p], covariance[1 : p + 1])
        left = float(covariance[0] - coefficients @ covariance[1 : p + 1])
        if left <= 0.0:
            break
        criterion = n * np.log(left) + p * np.log(n)
        if criterion < least:
            best, least = (coefficients, left), criterion
    return best[0], float(np.sqrt(best[1]))


def whitened(coefficients: Array, rows: Array) -> Array:
    """Take the colour out of a stretch.

    Parameters
    ----------
    coefficients
        Of `fit_noise`.
    rows
        Residuals or regressors, shape (n,) or (n, m); the first p rows stay coloured in part.
    """
    if coefficients.size == 0:
        return rows
    result: Array = lfilter(np.r_[1.0, -coefficients], [1.0], rows, axis=0)
    return result


def coloured_back(coefficients: Array, rows: Array) -> Array:
    """Apply the transpose of the colouring filter, which runs back in time.

    Parameters
    ----------
    coefficients
        Of `fit_noise`.
    rows
        Regressors of a stretch, shape (n, m).

    Returns
    -------
    Array
        Z with ``Zᵀ Z = rowsᵀ Γ rows``, Γ the noise's covariance over its white part's variance.
    """
    back: Array = lfilter([1.0], np.r_[1.0, -coefficients], rows[::-1], axis=0)[::-1]
    return back
