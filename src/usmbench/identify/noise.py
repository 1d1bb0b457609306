"""Coloured noise: an autoregressive model of what the simulation leaves."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

Array = NDArray[np.float64]

HIGHEST_ORDER = 10
_EXACT = 1e-6  # share of the variance that is left


def fit_noise(pieces: Sequence[Array]) -> tuple[Array, float]:
    """Fit an autoregressive model to residuals, its order by Schwarz's criterion.

    Parameters
    ----------
    pieces
        Residuals of unbroken stretches, each of shape (n_k,), of about zero mean.

    Returns
    -------
    coefficients
        c of ``e(t) = Σ c_i e(t−i) + white``, shape (p,); p may be 0.
    white
        Standard deviation of the white part.
    """
    n = sum(piece.size for piece in pieces)
    order = max(0, min(HIGHEST_ORDER, n // 20, max(p.size for p in pieces) - 1))
    covariance = np.zeros(order + 1)
    for piece in pieces:
        for k in range(min(order + 1, piece.size)):
            covariance[k] += float(piece[k:] @ piece[: piece.size - k]) / max(n, 1)
    if covariance[0] <= 0.0:
        return np.empty(0), 0.0
    return autoregression(covariance, n)


def autoregression(covariance: Array, n: float) -> tuple[Array, float]:
    """Return the autoregressive noise with given autocovariances, its order by BIC.

    Parameters
    ----------
    covariance
        At each lag, shape (orders + 1,).
    n
        Rows that it was taken over.

    Returns
    -------
    ar
        Coefficients of n_t = Σ ar_i n_{t−i} + innovation, shape (p,).
    innovation
        Standard deviation of the innovation.
    """
    best, chosen = np.inf, (np.empty(0), 1.0)
    for order in range(covariance.size):
        ar = solve_toeplitz(covariance[:order], covariance[1 : order + 1]) if order else np.empty(0)
        left = float(covariance[0] - ar @ covariance[1 : order + 1])
        if not left > _EXACT * float(covariance[0]):
            break  # no noise has these autocovariances, or the next value follows from the last
        score = n * np.log(left) + order * np.log(max(n, 2.0))
        if score < best:
            best, chosen = score, (np.asarray(ar, dtype=np.float64), float(np.sqrt(left)))
    return chosen


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
