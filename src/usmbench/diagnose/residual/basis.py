"""Directions in which a model may be wrong."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Basis:
    """An orthonormal basis of carried columns.

    Parameters
    ----------
    vectors
        Shape (M, rank).
    """

    vectors: Array

    def square(self, carried: Array) -> float:
        """Return the square of a carried residual's projection.

        Parameters
        ----------
        carried
            Shape (M,).
        """
        part = self.vectors.T @ carried
        return float(part @ part)
