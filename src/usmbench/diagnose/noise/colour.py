"""The colour of a noise from its autocovariance, and what fitting a curve has taken from that.

With columns U in their standard deviations, ``H = U (UᵀU + 1)⁻¹ Uᵀ`` is what a fit makes of the
noise, and its residual has the covariance ``(1 − H) Σ (1 − H)``, where the noise has Σ. In a
staircase of few windows a level a curve follows the slow part of the noise, and what is left looks
whiter and smaller than the noise of the next run.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.signal import lfilter, oaconvolve

from usmbench.identify.noise import autoregression

Array = NDArray[np.float64]

_LEAST_SHARE = 1e-3  # of the noise along a direction that is worth while
_MEMORY = 400  # windows
_ANSWER = 2000  # windows after which even a slow noise has answered
_ROUNDS = 5


def autocovariance(ar: Array, innovation: float, lags: int) -> Array:
    """Return the autocovariance of an autoregressive noise at lags from 0 on, shape (lags + 1,).

    Parameters
    ----------
    ar
        Coefficients, shape (p,).
    innovation
        Standard deviation of the innovation, as a share of the noise's level.
    lags
        The longest lag, in windows.
    """
    answer = lfilter([innovation], np.r_[1.0, -ar], np.eye(1, lags + _ANSWER)[0])
    return np.array([answer[k:] @ answer[: answer.size - k] for k in range(lags + 1)])


def taken_by_fit(fitted: Sequence[Array], left: Array, n: float) -> Array:
    """Return what a fit has taken from the autocovariance of its residual.

    The noise is white at first; each round takes the colour of the round before.

    Parameters
    ----------
    fitted
        Columns on the rows that count, in standard deviations over the noise there, shape (n_k, m)
        a stretch.
    left
        Autocovariance of the residual, shape (lags,).
    n
        Rows that it was taken over.

    Returns
    -------
    Array
        At each lag, shape (lags,).
    """
    more = np.zeros_like(left)
    basis, share = _hat(fitted)
    noise = np.empty(0), float(np.sqrt(left[0]))
    for _ in range(_ROUNDS):
        more = _taken(basis, share, *noise, left.size)
        # A fit that took more than half has left too little to tell how much it was.
        more *= min(1.0, float(left[0]) / max(float(more[0]), 1e-12))
        noise = autoregression(left + more, n)
    return more


def _hat(columns: Sequence[Array]) -> tuple[list[Array], Array]:
    """Return Q, cut as the stretches are, and h of ``H = Q diag(h) Qᵀ``."""
    stacked = np.concatenate(list(columns))
    power, ways = eigh(stacked.T @ stacked)
    share = np.maximum(power, 0.0) / (1.0 + np.maximum(power, 0.0))
    worth = share > _LEAST_SHARE
    basis = stacked @ (ways[:, worth] / np.sqrt(power[worth]))
    return np.split(basis, np.cumsum([c.shape[0] for c in columns])[:-1]), share[worth]


def _taken(
    basis: Sequence[Array], share: Array, ar: Array, innovation: float, n_lags: int
) -> Array:
    """Return what a fit takes from each autocovariance of a noise: HΣ + ΣH − HΣH."""
    covariance = autocovariance(ar, innovation, _MEMORY - 1)
    spread = [_times(covariance, q) * share for q in basis]
    inner = sum((q.T @ s for q, s in zip(basis, spread, strict=True)), np.zeros(()))
    taken, pairs = np.zeros(n_lags), np.zeros(n_lags)
    for q, s in zip(basis, spread, strict=True):
        twice = s - 0.5 * (q * share) @ inner
        for k in range(min(n_lags, q.shape[0])):
            m = q.shape[0] - k
            taken[k] += float(np.sum(q[:m] * twice[k:]) + np.sum(twice[:m] * q[k:]))
            pairs[k] += m
    return taken / np.maximum(pairs, 1.0)


def _times(covariance: Array, columns: Array) -> Array:
    """Multiply columns by the noise's covariance matrix."""
    known = covariance[: columns.shape[0]]
    both_ways = np.r_[known[:0:-1], known][:, np.newaxis]
    return np.asarray(oaconvolve(columns, both_ways, mode="same", axes=0), dtype=np.float64)
