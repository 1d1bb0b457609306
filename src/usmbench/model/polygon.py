"""Polygons over nodes: their hat functions, and how much they turn."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def hats(values: Array, nodes: Array) -> Iterator[Array]:
    """Yield the hat function of each node, held beyond the last ones.

    Parameters
    ----------
    values
        Where, shape (N,).
    nodes
        Rising, in the unit of the values.

    Yields
    ------
    Array
        Shape (N,).
    """
    left = np.clip(np.searchsorted(nodes, values, side="right") - 1, 0, nodes.size - 2)
    share = np.clip((values - nodes[left]) / (nodes[left + 1] - nodes[left]), 0.0, 1.0)
    for k in range(nodes.size):
        yield np.where(left == k, 1.0 - share, 0.0) + np.where(left == k - 1, share, 0.0)


def turns(nodes: Array) -> Array:
    """Return by how much the slope turns at each inner node, as a matrix on the nodes' heights.

    Parameters
    ----------
    nodes
        Rising, shape (K,).

    Returns
    -------
    Array
        Shape (K − 2, K), in one over the unit of the nodes.
    """
    slopes = np.diff(np.eye(nodes.size), axis=0) / np.diff(nodes)[:, None]
    turned: Array = np.diff(slopes, axis=0)
    return turned
