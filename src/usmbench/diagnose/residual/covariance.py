"""The residual's covariance: the noise, and what may differ without being news.

``C = noise + Σ τ² u uᵀ``, where each column u is something that may differ: the curve's own error,
the steps' mean jitter, gain and friction of the run. U is kept as shapes, and the ways in which
they may differ together.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag as dense_blocks
from scipy.sparse import block_diag, csr_array, diags_array

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.diagnose.noise.whitening import whitening
from usmbench.diagnose.residual.carrier import Carrier
from usmbench.diagnose.residual.columns import Columns

Array = NDArray[np.float64]

_BESIDE = 2  # windows: one that is off may have a neighbour that is, too


def whitened_by(noise: Noise, stretches: Sequence[Stretch], weights: Array | None) -> csr_array:
    """Return what makes the noise of all stretches white, shape (N, N).

    Parameters
    ----------
    noise
        The noise.
    stretches
        The runs, of N rows.
    weights
        Factor on each whitened row, shape (N,); None for 1.
    """
    plain = csr_array(block_diag([whitening(noise, s) for s in stretches]))
    return plain if weights is None else csr_array(diags_array(weights) @ plain)


@dataclass(frozen=True, slots=True)
class Covariance:
    """Noise, and what is no news.

    Parameters
    ----------
    filter_
        Makes the noise white, shape (N, N).
    shapes
        What may differ, in rad/s, shape (N, S).
    root
        Square root of the shapes' covariance, shape (S, K).
    """

    filter_: csr_array
    shapes: Columns
    root: Array

    @classmethod
    def of(cls, filter_: csr_array, known: Knowledge, stretches: Sequence[Stretch]) -> "Covariance":
        """Return the covariance of runs.

        Parameters
        ----------
        filter_
            Makes the noise white, shape (N, N).
        known
            What is known beforehand.
        stretches
            The runs.
        """
        shapes, root = known.background(stretches)
        columns, order = Columns.of(shapes)
        return cls(filter_, columns, root[order])

    def by(self, filter_: csr_array) -> "Covariance":
        """Return it with another noise.

        Parameters
        ----------
        filter_
            Makes that noise white, shape (N, N).
        """
        return replace(self, filter_=filter_)

    def also(self, shapes: Array, deviation: float, kept: Array | float = 1.0) -> "Covariance":
        """Return it where something else may differ.

        Parameters
        ----------
        shapes
            What, in rad/s, shape (N, S).
        deviation
            How many times it, as standard deviation.
        kept
            Factor on each whitened row, shape (N,), or on all.
        """
        root = dense_blocks(self.root, deviation * np.eye(shapes.shape[1]))
        every = np.broadcast_to(kept, (len(shapes),))
        filter_ = csr_array(diags_array(every) @ self.filter_)
        return Covariance(filter_, self.shapes.beside(shapes), root)

    def carrier(self, rows: Mask) -> Carrier:
        """Return what carries a residual on some rows.

        Parameters
        ----------
        rows
            Which, shape (N,).
        """
        return Carrier.of(self.filter_[rows], self.shapes, self.root)

    def unsure_rad_s(self, rows: Mask) -> Array:
        """Return how far off a residual may be by what is no news, shape (rows,).

        Parameters
        ----------
        rows
            Those that are asked for, shape (N,).
        """
        return self.shapes.of_rows(rows).size_of_rows(self.root)

    def unsure_beside_rad_s(self, rows: Mask) -> Array:
        """Return by how much more a residual may be off than around it, shape (rows,).

        Parameters
        ----------
        rows
            Those that are asked for, shape (N,), each against one on either side.
        """
        at, last = np.flatnonzero(rows), rows.size - 1
        beside = [np.clip(at + way * _BESIDE, 0, last) for way in (-1, 1)]
        each = np.arange(at.size)
        weights = np.repeat([1.0, -0.5, -0.5], at.size)
        where = (np.tile(each, 3), np.concatenate([at, *beside]))
        differences = self.shapes.filtered(csr_array((weights, where), shape=(at.size, rows.size)))
        return differences.size_of_rows(self.root)

    def unsure_along(self, signal: Array) -> float:
        """Return the standard deviation of the product of a signal and what is no news.

        Parameters
        ----------
        signal
            In rad/s, shape (N,).
        """
        return float(np.linalg.norm(self.root.T @ self.shapes.along(signal)))
