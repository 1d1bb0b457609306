"""Which operating points a row lies between, and how much each counts."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError

from usmbench.errors import InputError
from usmbench.model.hammerstein import OperatingPoint

Array = NDArray[np.float64]

_SAME = 1e-6  # share of the points' spread within which two operating points are one


def point_weights(
    points: Sequence[OperatingPoint],
    n: int,
    frequency_hz: Array | None,
    torque_nm: Array | None,
) -> tuple[list[Array], NDArray[np.bool_]]:
    """Return the weight of every operating point on every row.

    Parameters
    ----------
    points
        The model's operating points.
    n
        Number of rows.
    frequency_hz, torque_nm
        Commanded values, shape (n,), or None where unknown.

    Returns
    -------
    weights
        One array of shape (n,) a point; they add up to 1 on each row. Barycentric within the
        triangles (or the line) the points span; on the nearest point alone outside.
    outside
        True where the row lies outside what the points span, shape (n,).

    Raises
    ------
    InputError
        Points that differ in what the run does not say.
    """
    nodes = np.array([[p.frequency_hz or 0.0, p.torque_nm or 0.0] for p in points])
    for name, column, values in (("frequency_hz", 0, frequency_hz), ("torque_nm", 1, torque_nm)):
        if values is None and np.ptp(nodes[:, column]) > 0.0:
            raise InputError(
                f"the model has several operating points, and the run has no {name} to say at "
                "which it was; add that column to the run"
            )
    asked = np.tile(nodes[0], (n, 1))
    for column, (values, known) in enumerate(
        [(frequency_hz, points[0].frequency_hz), (torque_nm, points[0].torque_nm)]
    ):
        if values is not None and known is not None:
            asked[:, column] = values
    # A dwell repeats its commands over many windows: work on the distinct ones.
    distinct, place = np.unique(asked, axis=0, return_inverse=True)
    table, outside = _weights_of(nodes, distinct)
    return [table[place.ravel(), k] for k in range(len(points))], outside[place.ravel()]


def slope_table(points: Sequence[OperatingPoint]) -> Array | None:
    """Return by how much each point's curve counts in f ∂v/∂f at each point.

    A point's slope is that of the parabola through it and its two nearest neighbours in frequency;
    of the line where there is one only.

    Parameters
    ----------
    points
        The model's operating points.

    Returns
    -------
    array or None
        A row for each point's slope, shape (P, P); None where a point has no neighbour in frequency
        at its torque.
    """
    table = np.zeros((len(points), len(points)))
    for i, point in enumerate(points):
        steps_hz = _nearest(points, i)
        if not steps_hz:
            return None
        for k, step_hz in steps_hz.items():
            others = [other for j, other in steps_hz.items() if j != k]
            share = np.prod([other / (other - step_hz) for other in others]) / step_hz
            table[i, k] = share * float(point.frequency_hz or 0.0)
        table[i, i] = -table[i].sum()
    return table


def places_among(points: Sequence[OperatingPoint], weights: Sequence[Array]) -> tuple[Array, ...]:
    """Return where every row lies in frequency and in torque, as far as the points differ in them.

    Parameters
    ----------
    points
        The model's operating points.
    weights
        As `point_weights` returns them.

    Returns
    -------
    tuple of Array
        From −1 at the lowest to 1 at the highest, shape (N,) each.
    """
    found = []
    for values in ([p.frequency_hz or 0.0 for p in points], [p.torque_nm or 0.0 for p in points]):
        low, high = min(values), max(values)
        if high > low:
            place = (2.0 * np.array(values) - low - high) / (high - low)
            found.append(place @ np.array(weights))
    return tuple(found)


def _nearest(points: Sequence[OperatingPoint], i: int) -> dict[int, float]:
    """Frequency of a point's nearest neighbours at its torque, less its own; two at most."""
    here = points[i]
    steps_hz = {
        k: point.frequency_hz - here.frequency_hz
        for k, point in enumerate(points)
        if point.frequency_hz is not None
        and here.frequency_hz is not None
        and point.frequency_hz != here.frequency_hz
        and point.torque_nm == here.torque_nm
    }
    return dict(sorted(steps_hz.items(), key=lambda step: abs(step[1]))[:2])


def _weights_of(nodes: Array, asked: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Weights (rows × nodes) of distinct requests."""
    spread = np.ptp(nodes, axis=0)
    scale = np.where(spread > 0.0, spread, np.maximum(np.abs(nodes[0]), 1.0))
    unit, unit_asked = nodes / scale, asked / scale
    distance = np.linalg.norm(unit_asked[:, None, :] - unit[None, :, :], axis=2)
    table = np.zeros((asked.shape[0], nodes.shape[0]))
    table[np.arange(asked.shape[0]), distance.argmin(axis=1)] = 1.0
    exact = distance.min(axis=1) <= _SAME
    for row in np.flatnonzero(~exact):
        weights = _between(unit, unit_asked[row])
        if weights is not None:
            table[row], exact[row] = weights, True
    return table, ~exact


def _between(unit: Array, asked: Array) -> Array | None:
    """Barycentric weights in the points' triangle or line; None outside."""
    varies = np.ptp(unit, axis=0) > _SAME
    if np.any(np.abs(asked - unit[0])[~varies] > _SAME) or not np.any(varies):
        return None
    if np.count_nonzero(varies) == 1:
        return _on_line(unit[:, varies][:, 0], float(asked[varies][0]))
    try:
        mesh = Delaunay(unit)
    except QhullError:
        axis = np.linalg.svd(unit - unit.mean(axis=0))[2][0]
        off = np.linalg.norm(asked - unit[0] - axis * ((asked - unit[0]) @ axis))
        return _on_line(unit @ axis, float(asked @ axis)) if off <= _SAME else None
    triangle = int(mesh.find_simplex(asked[None, :], tol=_SAME)[0])
    if triangle < 0:
        return None
    inverse = mesh.transform[triangle]
    first = inverse[:2] @ (asked - inverse[2])
    weights = np.zeros(unit.shape[0])
    weights[mesh.simplices[triangle]] = np.r_[first, 1.0 - first.sum()]
    return weights


def _on_line(nodes: Array, asked: float) -> Array | None:
    """Linear interpolation weights between the two nodes beside `asked`."""
    order = np.argsort(nodes)
    if not nodes[order[0]] <= asked <= nodes[order[-1]]:
        return None
    right = int(np.clip(np.searchsorted(nodes[order], asked), 1, nodes.size - 1))
    low, high = order[right - 1], order[right]
    weights = np.zeros(nodes.size)
    share = (asked - nodes[low]) / (nodes[high] - nodes[low])
    weights[low], weights[high] = 1.0 - share, share
    return weights
