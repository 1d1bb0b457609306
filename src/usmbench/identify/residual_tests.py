"""Is anything left in the residual? Tests over all lags together, at their stated rate.

A band of ±1.96/√N around every lag of a correlogram is crossed by chance in most records of 25
lags. Here each question is one test: lagged columns are added to the regressors, projected off
them, and the share they explain is compared with its distribution (Breusch 1978 and Godfrey 1978
for serial correlation; an F test for the input). Both run on residuals whose colour has been
taken out, so that coloured noise is not taken for unmodelled motion.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc, fdtrc

from usmbench.identify.noise import whitened
from usmbench.identify.projected import Linearised
from usmbench.model.linear import delayed

Array = NDArray[np.float64]

SERIAL_LAGS = 25
INPUT_LAGS = 10
_RANK = 1e-9


@dataclass(frozen=True, slots=True)
class ResidualTest:
    """One test's outcome.

    Parameters
    ----------
    question
        What a small p-value says.
    statistic
        The statistic.
    degrees
        Its degrees of freedom.
    p_value
        Probability of a larger one where nothing is left.
    """

    question: str
    statistic: float
    degrees: int
    p_value: float


def serial_test(residual: Array, regressors: Array, lags: int = SERIAL_LAGS) -> ResidualTest:
    """Test for correlation with the residual's own past, all lags together.

    Parameters
    ----------
    residual
        Residual of a least-squares fit, white if nothing is left, shape (n,).
    regressors
        Regressors of that fit, shape (n, m): they make the residual's first lags correlated even
        where the noise is white.
    lags
        Number of lags.
    """
    past = np.column_stack([delayed(residual, k) for k in range(1, lags + 1)])
    explained, rank = _explained(residual, regressors, past)
    left = float(residual @ residual)
    statistic = residual.size * explained / left if left > 0.0 else 0.0
    return ResidualTest(
        "the noise has more colour", statistic, rank, float(chdtrc(rank, statistic))
    )


def input_test(residual: Array, regressors: Array, inputs: Array) -> ResidualTest:
    """Test whether further functions of the input explain some of the residual.

    Parameters
    ----------
    residual
        White residual of a least-squares fit, shape (n,).
    regressors
        Regressors of that fit, shape (n, m).
    inputs
        Further columns, such as the input at other lags, shape (n, k).
    """
    explained, rank = _explained(residual, regressors, inputs)
    left = float(residual @ residual) - explained
    free = residual.size - regressors.shape[1] - rank
    told = rank > 0 and left > 0.0
    statistic = explained / rank / (left / max(free, 1)) if told else 0.0
    p_value = 1.0 if not told else float(fdtrc(rank, max(free, 1), statistic))
    return ResidualTest("other dynamics act on the input", statistic, rank, p_value)


def residual_tests(
    pieces: Sequence[Linearised], dynamics: int, colour: Array
) -> tuple[ResidualTest, ResidualTest]:
    """Test what an output-error fit has left.

    Parameters
    ----------
    pieces
        Its stretches near the estimate.
    dynamics
        Number of parameters of the dynamics.
    colour
        Autoregressive coefficients of its residual.
    """
    residuals, regressors, inputs = [], [], []
    ordinates = {piece.point: piece.regressors.shape[1] - dynamics for piece in pieces}
    ends = np.cumsum([dynamics, *(ordinates[point] for point in sorted(ordinates))])
    for piece in pieces:
        n = piece.influence.size
        wide = np.zeros((n, int(ends[-1])))
        wide[:, :dynamics] = piece.regressors[:, -dynamics:] if dynamics else 0.0
        own = slice(int(ends[piece.point]), int(ends[piece.point + 1]))
        wide[:, own] = piece.regressors[:, : piece.regressors.shape[1] - dynamics]
        settled = piece.settled_rad_s
        lagged = np.column_stack(
            [delayed(settled, k, settled[0]) for k in range(1, INPUT_LAGS + 1)]
        )
        first = min(colour.size + INPUT_LAGS, n)
        residuals.append(whitened(colour, piece.influence)[first:])
        regressors.append(whitened(colour, wide)[first:])
        inputs.append(whitened(colour, lagged)[first:])
    residual, regressor = np.concatenate(residuals), np.vstack(regressors)
    return serial_test(residual, regressor), input_test(residual, regressor, np.vstack(inputs))


def _explained(residual: Array, regressors: Array, columns: Array) -> tuple[float, int]:
    """Sum of squares of the residual that columns explain beyond the regressors, and their rank."""
    base, singular, _ = np.linalg.svd(regressors, full_matrices=False)
    base = base[:, singular > _RANK * max(float(singular[0]), 1e-300)]
    size = np.linalg.norm(columns, axis=0)
    fresh = columns - base @ (base.T @ columns)
    span, singular, _ = np.linalg.svd(fresh / np.maximum(size, 1e-300), full_matrices=False)
    span = span[:, singular > _RANK**0.5]
    return float(np.sum((span.T @ residual) ** 2)), int(span.shape[1])
