"""Directions in which a model may be wrong."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

Array = NDArray[np.float64]

_RANK = 1e-6  # of the largest eigenvalue


@dataclass(frozen=True, slots=True)
class Basis:
    """An orthonormal basis of carried columns, as amounts of them: multiplied out it takes as much.

    Parameters
    ----------
    columns
        Shape (M, C).
    amounts
        How much of each makes a vector of the basis, shape (C, rank).
    """

    columns: Array
    amounts: Array

    @classmethod
    def of(cls, columns: Array) -> "Basis":
        """Return the basis of columns, without what is lost in rounding.

        Parameters
        ----------
        columns
            Shape (M, C).
        """
        products = columns.T @ columns
        size = np.sqrt(np.diag(products))
        kept = np.flatnonzero(size > 1e-9 * max(float(size.max(initial=0.0)), 1e-300))
        if kept.size == 0:
            return cls(columns, np.zeros((size.size, 0)))
        values, vectors = eigh(products[np.ix_(kept, kept)] / np.outer(size[kept], size[kept]))
        good = values > _RANK * values[-1]
        amounts = np.zeros((size.size, np.count_nonzero(good)))
        amounts[kept] = vectors[:, good] / np.sqrt(values[good]) / size[kept, None]
        return cls(columns, amounts)

    @property
    def rank(self) -> int:
        """How many vectors it has."""
        return int(self.amounts.shape[1])

    @property
    def vectors(self) -> Array:
        """The vectors, multiplied out, shape (M, rank)."""
        vectors: Array = self.columns @ self.amounts
        return vectors

    def square(self, carried: Array) -> float:
        """Return the square of a carried residual's projection.

        Parameters
        ----------
        carried
            Shape (M,).
        """
        part = self._along(carried)
        return float(part @ part)

    def rest(self, carried: Array) -> Array:
        """Return what of a carried residual no vector shows, shape (M,).

        Parameters
        ----------
        carried
            Shape (M,).
        """
        shown: Array = self.columns @ (self.amounts @ self._along(carried))
        return carried - shown

    def _along(self, carried: Array) -> Array:
        """Products of the vectors with a carried residual, shape (rank,)."""
        along: Array = self.amounts.T @ (self.columns.T @ carried)
        return along
