"""From a phase to the abscissa of the Bézier curve: the exact inverse of a rising polynomial."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.bernstein import bezier_slope, bezier_value

Array = NDArray[np.float64]

_TABLE_CELLS = 4096
_BLOCK = 16_384  # a block and its temporaries stay in the second-level cache
_MAX_STEPS = 60  # bisection alone halves a table cell to the last bit in fewer
_TOLERANCE = 4.0 * np.finfo(np.float64).eps


def check_knots(knots_deg: Array) -> None:
    """Refuse knots that do not span a curve.

    Parameters
    ----------
    knots_deg
        Abscissas of the control points, shape (d + 1,).

    Raises
    ------
    InputError
        Fewer than two knots, or knots that do not rise from one to the next.
    """
    if knots_deg.ndim != 1 or knots_deg.size < 2:
        raise InputError("a curve needs at least two knots")
    if not np.all(np.isfinite(knots_deg)):
        raise InputError("the knots must be finite numbers")
    steps = np.diff(knots_deg)
    if np.any(steps <= 0.0):
        at = int(np.argmax(steps <= 0.0))
        raise InputError(
            f"the knots must rise: knot {at + 2} ({knots_deg[at + 1]:g}°) is not above "
            f"knot {at + 1} ({knots_deg[at]:g}°)"
        )


def bezier_abscissa(phase_deg: Array, knots_deg: Array) -> Array:
    """Solve ``Σ_j Φ_j B_j^d(x) = φ`` for x, for every φ.

    With rising knots the left side rises from Φ_0 to Φ_d, so there is exactly one solution. A
    table gives a start good to about 10⁻⁶; Newton steps double its digits until rounding stops
    them, and a step that would leave the bracket of its table cell is replaced by bisection.

    Parameters
    ----------
    phase_deg
        Phases φ within [Φ_0, Φ_d], shape (N,).
    knots_deg
        Knots Φ, strictly rising, shape (d + 1,).

    Returns
    -------
    Array
        Abscissas in [0, 1], shape (N,).

    Raises
    ------
    InputError
        Knots that do not rise, or a phase outside them (or not a number).
    """
    check_knots(knots_deg)
    outside = ~((phase_deg >= knots_deg[0]) & (phase_deg <= knots_deg[-1]))
    if np.any(outside):
        raise InputError(
            f"phase {phase_deg[np.argmax(outside)]:g}° (and {np.count_nonzero(outside) - 1} more) "
            f"is outside the knots {knots_deg[0]:g}…{knots_deg[-1]:g}°; give knots that span the "
            "data"
        )
    nodes, table_deg = _table(tuple(knots_deg.tolist()))
    x = np.empty(phase_deg.shape)
    for start in range(0, phase_deg.size, _BLOCK):
        block = slice(start, start + _BLOCK)
        x[block] = _solve(phase_deg[block], knots_deg, nodes, table_deg)
    return x


@lru_cache(maxsize=64)
def _table(knots: tuple[float, ...]) -> tuple[Array, Array]:
    """Abscissas and phases to start from; the same knots come again and again."""
    knots_deg = np.array(knots)
    nodes = np.linspace(0.0, 1.0, _TABLE_CELLS + 1)
    table_deg = bezier_value(nodes, knots_deg)
    table_deg[0], table_deg[-1] = knots_deg[0], knots_deg[-1]
    return nodes, table_deg


def _solve(phase_deg: Array, knots_deg: Array, nodes: Array, table_deg: Array) -> Array:
    """Newton's method in each phase's own table cell."""
    x = np.interp(phase_deg, table_deg, nodes)
    step = _newton_step(x, phase_deg, knots_deg)
    cell = 1.0 / _TABLE_CELLS
    if np.any(np.abs(step) > cell):
        return _bracketed(phase_deg, knots_deg, nodes, table_deg)
    for _ in range(_MAX_STEPS):
        x -= step
        np.clip(x, 0.0, 1.0, out=x)
        largest = np.max(np.abs(step), initial=0.0)
        # The next error is about the square of this step over the cell: below rounding, stop.
        if largest * largest < _TOLERANCE * cell:
            break
        step = _newton_step(x, phase_deg, knots_deg)
    return x


def _bracketed(phase_deg: Array, knots_deg: Array, nodes: Array, table_deg: Array) -> Array:
    """Newton's method kept inside a shrinking bracket, for knots almost on top of each other."""
    index = np.clip(np.searchsorted(table_deg, phase_deg, side="right") - 1, 0, nodes.size - 2)
    low, high = nodes[index], nodes[index + 1]
    x = 0.5 * (low + high)
    for _ in range(_MAX_STEPS):
        below = bezier_value(x, knots_deg) < phase_deg
        low, high = np.where(below, x, low), np.where(below, high, x)
        moved = x - _newton_step(x, phase_deg, knots_deg)
        inside = (moved > low) & (moved < high)
        moved = np.where(inside, moved, 0.5 * (low + high))
        if np.max(np.abs(moved - x)) <= _TOLERANCE:
            break
        x = moved
    return x


def _newton_step(x: Array, phase_deg: Array, knots_deg: Array) -> Array:
    """Return what x is to be reduced by."""
    return (bezier_value(x, knots_deg) - phase_deg) / bezier_slope(x, knots_deg)
