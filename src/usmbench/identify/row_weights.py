"""How much rows count, and what becomes of their regressors."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class RowWeights:
    """How much each row of a stretch counts.

    Parameters
    ----------
    spread
        Standard deviation of the row's kind over that of the quietest kind, shape (n,).
    robust
        Square root of the row's robust weight, 0 for an outlier and 1 in the middle, shape (n,).
    """

    spread: Array
    robust: Array

    @property
    def root(self) -> Array:
        """Square root of the whole weight, shape (n,)."""
        root: Array = self.robust / self.spread
        return root


def times(weight: Array, columns: Array) -> Array:
    """Weight the rows of one or several columns.

    Parameters
    ----------
    weight
        Weight of each row, shape (N,) or more.
    columns
        Shape (N,) or (N, K).
    """
    weight = weight[: columns.shape[0]]
    weighted: Array = (columns.T * weight).T
    return weighted


def of_unit_length(shape: Array) -> Array:
    """Scale a shape to unit length, or leave it 0.

    Parameters
    ----------
    shape
        Shape (n,).
    """
    scaled: Array = shape / max(float(np.linalg.norm(shape)), 1e-300)
    return scaled


def without(shape: Array, columns: Array) -> Array:
    """Project one or several columns, in place, off a shape of unit length.

    Parameters
    ----------
    shape
        Shape (n,); beyond its n rows it is 0.
    columns
        Shape (N,) or (N, K), N at least n.
    """
    head = columns[: shape.size]
    head -= np.multiply.outer(shape, shape @ head)
    return columns
