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
from scipy.linalg import eigh, solve_triangular
from scipy.special import chdtrc, fdtrc

from usmbench.identify.linearised import Linearisation
from usmbench.identify.noise import whitened
from usmbench.identify.triangle import full_rank

Array = NDArray[np.float64]

SERIAL_LAGS = 25
INPUT_LAGS = 10
_RANK = 1e-9  # of a column's power: less is within the regressors


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


class FittedRows:
    """What a least-squares fit left, and what it was fitted by.

    Parameters
    ----------
    residuals
        Residual over each unbroken stretch, white if nothing is left, shape (n_k,).
    regressors
        Regressors of the fit, shape (n_k, m).
    """

    def __init__(self, residuals: Sequence[Array], regressors: Sequence[Array]) -> None:
        self.residuals, self._regressors = residuals, regressors
        self.n, self.parameters = sum(r.size for r in residuals), regressors[0].shape[1]
        corner = full_rank(*regressors)
        self._inverse = solve_triangular(corner, np.eye(self.parameters))

    def explained(self, columns: Sequence[Array]) -> tuple[float, float, int]:
        """Return what further columns explain of the residual, beyond the regressors.

        Parameters
        ----------
        columns
            Shape (n_k, p).

        Returns
        -------
        explained, whole, rank
            Sum of squares that they explain, that of the residual, and their rank.
        """
        both = [np.column_stack(pair) for pair in zip(columns, self.residuals, strict=True)]
        power = sum((np.sum(block**2, axis=0) for block in both), np.zeros(1))
        for _ in range(2):  # the second round takes away what the first one rounds
            self._project(both)
        size = np.sqrt(np.maximum(power, 1e-300))
        products = sum((block.T @ block for block in both), np.zeros(1)) / np.outer(size, size)
        share, axes = eigh(products[:-1, :-1])
        fresh = share > _RANK
        told = axes[:, fresh].T @ products[:-1, -1]
        whole = float(power[-1])
        return whole * float(np.sum(told**2 / share[fresh])), whole, int(np.count_nonzero(fresh))

    def _project(self, columns: Sequence[Array]) -> None:
        """Take out of columns, in place, what the regressors explain of them."""
        pairs = list(zip(self._regressors, columns, strict=True))
        moment = sum((regressors.T @ own for regressors, own in pairs), np.zeros(1))
        along = self._inverse @ (self._inverse.T @ moment)
        for regressors, own in pairs:
            own -= regressors @ along


def serial_test(fitted: FittedRows, taken: int = 0) -> ResidualTest:
    """Test for correlation with the residual's own past, all lags together.

    The regressors make the residual's first lags correlated even where the noise is white. A colour
    that was fitted and taken out has taken as many degrees of freedom with it (Box and Pierce 1970,
    doi:10.1080/01621459.1970.10481180).

    Parameters
    ----------
    fitted
        Residual and regressors of the fit.
    taken
        Coefficients of the colour that was taken out of the residual.
    """
    past = [_lagged(residual, SERIAL_LAGS, 0.0) for residual in fitted.residuals]
    explained, left, rank = fitted.explained(past)
    statistic = fitted.n * explained / left if left > 0.0 else 0.0
    degrees = max(rank - taken, 1)
    return ResidualTest(
        "the noise has more colour", statistic, degrees, float(chdtrc(degrees, statistic))
    )


def input_test(fitted: FittedRows, inputs: Sequence[Array]) -> ResidualTest:
    """Test whether further functions of the input explain some of the residual.

    Parameters
    ----------
    fitted
        Residual and regressors of the fit.
    inputs
        Further columns over each stretch, such as the input at other lags, shape (n_k, p).
    """
    explained, whole, rank = fitted.explained(inputs)
    left, free = whole - explained, max(fitted.n - fitted.parameters - rank, 1)
    told = rank > 0 and left > 0.0
    statistic = explained / rank / (left / free) if told else 0.0
    p_value = 1.0 if not told else float(fdtrc(rank, free, statistic))
    return ResidualTest("other dynamics act on the input", statistic, rank, p_value)


def residual_tests(
    linearised: Linearisation, dynamics: int, colour: Array
) -> tuple[ResidualTest, ResidualTest]:
    """Test what an output-error fit has left.

    Parameters
    ----------
    linearised
        Its stretches near the estimate.
    dynamics
        Number of parameters of the dynamics.
    colour
        Autoregressive coefficients of its residual.
    """
    residuals, regressors, inputs = [], [], []
    ordinates = {piece.point: piece.regressors.shape[1] - dynamics for piece in linearised.pieces}
    ends = np.cumsum([dynamics, *(ordinates[point] for point in sorted(ordinates))])
    for piece in linearised.pieces:
        n, own = piece.influence.size, ordinates[piece.point]
        wide = np.zeros((n, int(ends[-1])))
        wide[:, :dynamics] = piece.regressors[:, own:]
        wide[:, ends[piece.point] : ends[piece.point + 1]] = piece.regressors[:, :own]
        settled = piece.settled_rad_s
        lagged = _lagged(settled, INPUT_LAGS, float(settled[0]))
        first = min(colour.size + INPUT_LAGS, n)
        residuals.append(whitened(colour, piece.influence)[first:])
        regressors.append(whitened(colour, wide)[first:])
        inputs.append(whitened(colour, lagged)[first:])
    fitted = FittedRows(residuals, regressors)
    return serial_test(fitted, colour.size), input_test(fitted, inputs)


def _lagged(signal: Array, lags: int, before: float) -> Array:
    """Put a signal's lags 1, 2 … side by side."""
    columns = np.empty((signal.size, lags), order="F")
    for k in range(1, lags + 1):
        columns[:k, k - 1] = before
        columns[k:, k - 1] = signal[:-k]
    return columns
