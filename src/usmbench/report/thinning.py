"""Lines of more points than a screen has columns."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def thinned(x: Array, y: Array, n_columns: int) -> tuple[Array, Array]:
    """Return lowest and highest point of each column: a line that looks the same.

    Parameters
    ----------
    x, y
        Points, shape (K,).
    n_columns
        Columns; a line with fewer points than twice that many stays as it is.
    """
    if x.size <= 2 * n_columns:
        return x, y
    keep: list[int] = []
    for rows in np.array_split(np.arange(x.size), n_columns):
        extremes = {int(rows[np.argmin(y[rows])]), int(rows[np.argmax(y[rows])])}
        keep.extend(sorted(extremes))
    return x[keep], y[keep]
