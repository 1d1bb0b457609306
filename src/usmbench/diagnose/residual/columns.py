"""Columns of which a few are full and the others nearly empty, each kind kept as it is fastest."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, hstack, vstack

from usmbench.diagnose.cutting.stretches import Mask

Array = NDArray[np.float64]

_FULL = 0.15  # share of its rows from which a column is cheaper with its zeros
_AT_ONCE = 4096  # rows


@dataclass(frozen=True)
class Columns:
    """A matrix in two parts.

    Parameters
    ----------
    full
        The full columns, shape (N, F).
    empty
        The nearly empty ones, shape (N, E).
    """

    full: Array
    empty: csr_array

    @classmethod
    def of(cls, blocks: Sequence[Array]) -> "tuple[Columns, NDArray[np.intp]]":
        """Return a matrix in two parts, and the place that each of their columns had in it.

        Parameters
        ----------
        blocks
            The matrix in blocks of rows, shape (N, F + E) together.

        Returns
        -------
        tuple of Columns and NDArray
            The parts; places, shape (F + E,).
        """
        # Not all at once: of a long run the zeros would fill the memory.
        filled = np.sum([np.count_nonzero(block, axis=0) for block in blocks], axis=0)
        fills = filled > _FULL * sum(len(block) for block in blocks)
        order = np.argsort(~fills, kind="stable")
        full = np.concatenate([block[:, fills] for block in blocks])
        empty = vstack([csr_array(block[:, ~fills]) for block in blocks], format="csr")
        return cls(full, csr_array(empty)), order

    @property
    def gram(self) -> Array:
        """The columns' products with each other, shape (F + E, F + E)."""
        crossed = np.asarray(self.empty.T @ self.full)
        alike = (self.empty.T @ self.empty).toarray()
        return np.block([[self.full.T @ self.full, crossed.T], [crossed, alike]])

    def of_rows(self, rows: Mask) -> "Columns":
        """Return some rows of it.

        Parameters
        ----------
        rows
            Which, shape (N,).
        """
        return Columns(self.full[rows], self.empty[rows])

    def filtered(self, filter_: csr_array) -> "Columns":
        """Return a filter's output for each column.

        Parameters
        ----------
        filter_
            Shape (N, N).
        """
        return Columns(np.asarray(filter_ @ self.full), csr_array(filter_ @ self.empty))

    def beside(self, further: Array) -> "Columns":
        """Return it with further columns, which come last.

        Parameters
        ----------
        further
            Shape (N, C).
        """
        return Columns(self.full, csr_array(hstack([self.empty, csr_array(further)])))

    def combined(self, amounts: Array) -> Array:
        """Return a sum of the columns.

        Parameters
        ----------
        amounts
            How much of each, shape (F + E,), or (F + E, M) for M sums.
        """
        n_full = self.full.shape[1]
        total = self.full @ amounts[:n_full]
        total += self.empty @ amounts[n_full:]
        return total

    def size_of_rows(self, amounts: Array) -> Array:
        """Return the root of the sum of squares of each row of sums of the columns, shape (N,).

        Parameters
        ----------
        amounts
            How much of each column, shape (F + E, M).
        """
        # Not all at once: of a long run the sums take as much memory as the columns.
        parts = [slice(i, i + _AT_ONCE) for i in range(0, max(len(self.full), 1), _AT_ONCE)]
        sums = (Columns(self.full[p], self.empty[p]).combined(amounts) for p in parts)
        return np.concatenate([np.linalg.norm(part, axis=1) for part in sums])

    def along(self, signal: Array) -> Array:
        """Return each column's product with a signal, shape (F + E,) or (F + E, M).

        Parameters
        ----------
        signal
            Shape (N,), or (N, M) for M of them.
        """
        return np.concatenate([self.full.T @ signal, self._across @ signal])

    @cached_property
    def _across(self) -> csr_array:
        """The nearly empty columns as rows: asked thousands of times."""
        return csr_array(self.empty.T)
