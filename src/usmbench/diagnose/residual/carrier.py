"""Carry a residual as the vector whose square is its deviance, given what is no news.

With the noise whitened to 1, ``eᵀ C⁻¹ e = min_β |e − Uβ|² + |β|²`` (U with its deviations in it),
so a residual is carried as ``[e − Uβ̂; β̂]``.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.sparse import csr_array

from usmbench.diagnose.residual.columns import Columns

Array = NDArray[np.float64]

_HIDDEN = 0.05  # share of the noise's variance below which a shape's own does not count


@dataclass(frozen=True, slots=True)
class Pulled:
    """Residuals by what their products take: less than to carry them.

    Parameters
    ----------
    white
        With the noise whitened, shape (R, M).
    taken
        What is no news takes of them, along each of its ways, shape (K, M).
    """

    white: Array
    taken: Array

    def products(self, other: "Pulled") -> Array:
        """Return the products of these residuals, carried, with others, shape (M, L).

        Parameters
        ----------
        other
            L residuals.
        """
        return np.asarray(self.white.T @ other.white - self.taken.T @ other.taken)

    def one(self, k: int) -> "Pulled":
        """Return one of them.

        Parameters
        ----------
        k
            Which.
        """
        return Pulled(self.white[:, k : k + 1].copy(), self.taken[:, k : k + 1])


@dataclass(frozen=True, slots=True)
class Carrier:
    """The rows that count, and on them what is no news, as far as it exceeds the noise.

    Parameters
    ----------
    whitening
        Whitens all rows and keeps those that count, shape (R, N).
    background
        Whitened shapes on these, shape (R, S).
    ways
        In which ways they may differ, shape (S, K).
    tension
        UᵀU + 1, which is diagonal, shape (K,).
    """

    whitening: csr_array
    background: Columns
    ways: Array
    tension: Array

    @classmethod
    def of(cls, whitening: csr_array, shapes: Columns, root: Array) -> "Carrier":
        """Return the carrier of some rows.

        Parameters
        ----------
        whitening
            Whitens all rows and keeps those that count, shape (R, N).
        shapes
            What is no news on all rows, in rad/s, shape (N, S).
        root
            Square root of the shapes' covariance, shape (S, L).
        """
        judged = shapes.filtered(whitening)
        power, ways = eigh(root.T @ judged.gram @ root)
        shown = power > _HIDDEN
        return cls(whitening, judged, root @ ways[:, shown], 1.0 + power[shown])

    def carried(self, signal: Array) -> Array:
        """Return a residual as the vector whose square is its deviance.

        Parameters
        ----------
        signal
            The residual on all rows, in rad/s, shape (N,), or (N, M) for M of them at once.

        Returns
        -------
        Array
            Shape (R + K,) or (R + K, M).
        """
        white, pull = self._pulled(signal)
        beta = (pull.T / self.tension).T
        carried: Array = np.concatenate([white, beta])
        carried[: len(white)] -= self.background.combined(self.ways @ beta)
        return carried

    def square(self, signal: Array) -> float:
        """Return the deviance of a residual.

        Parameters
        ----------
        signal
            The residual on all rows, in rad/s, shape (N,).
        """
        white, pull = self._pulled(signal)
        return float(white @ white - pull @ (pull / self.tension))

    def pulled(self, signal: Array) -> Pulled:
        """Return residuals by what their products take.

        Parameters
        ----------
        signal
            The residuals on all rows, in rad/s, shape (N, M).
        """
        white, pull = self._pulled(signal)
        return Pulled(white, pull / np.sqrt(self.tension)[:, None])

    def departed(self, signal: Array) -> Array:
        """Return by how much each of the shapes most likely departs, shape (S,).

        Parameters
        ----------
        signal
            The residual on all rows, in rad/s, shape (N,).
        """
        departed: Array = self.ways @ (self._pulled(signal)[1] / self.tension)
        return departed

    def _pulled(self, signal: Array) -> tuple[Array, Array]:
        """Return whitened residuals, and how they pull at each of the ways, shape (K, …)."""
        white = np.asarray(self.whitening @ signal)
        return white, self.ways.T @ self.background.along(white)

    def excuses(self, carried: Array) -> tuple[Array, float]:
        """Return how far a residual makes what is no news depart, and what this makes of the noise.

        Parameters
        ----------
        carried
            The carried residual, shape (R + K,).

        Returns
        -------
        tuple of Array and float
            Departures in their standard deviations, independent where nothing is wrong, shape
            (K,); sum of squares of what they are in the whitened rows.
        """
        beta = carried[carried.size - self.tension.size :]
        power = self.tension - 1.0
        return beta * np.sqrt(self.tension / power), float(power @ beta**2)
