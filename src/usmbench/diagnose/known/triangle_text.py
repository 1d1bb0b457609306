"""A lower triangular matrix as text: half-precision numbers in base 64, row by row.

Numbers written out would make a model file ten times as long. Half precision keeps three digits of
each: of a covariance's root in priors, that is far below what any run can show.
"""

from base64 import b64decode, b64encode

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LARGEST = float(np.finfo(np.float16).max)


def triangle_text(matrix: Array) -> str:
    """Return the text of a matrix; numbers that half precision cannot hold become its largest.

    Parameters
    ----------
    matrix
        Lower triangular, in any unit, shape (K, K).
    """
    values = np.clip(matrix[np.tril_indices(matrix.shape[0])], -_LARGEST, _LARGEST)
    return b64encode(values.astype("<f2").tobytes()).decode("ascii")


def triangle_of(text: str, size: int) -> Array:
    """Return the matrix that `triangle_text` wrote, shape (size, size).

    Parameters
    ----------
    text
        What it returned.
    size
        Rows of the matrix.

    Raises
    ------
    ValueError
        The text is no base 64, holds another number of values, or one that is no number.
    """
    wrong = ValueError(f"covariance_root is no triangle of {size} rows of numbers")
    try:
        values = np.frombuffer(b64decode(text, validate=True), "<f2").astype(np.float64)
    except ValueError:
        raise wrong from None
    if values.size != size * (size + 1) // 2 or not np.all(np.isfinite(values)):
        raise wrong
    matrix = np.zeros((size, size))
    matrix[np.tril_indices(size)] = values
    return matrix
