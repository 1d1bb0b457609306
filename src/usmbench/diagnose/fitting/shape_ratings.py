"""What a shape that was tried is worth, and what it is charged for: by its deviance alone."""

from collections.abc import Callable, Sequence

import numpy as np

Rate = Callable[[float, float], float]  # what a drop and the square of its change are worth
Rated = tuple[dict[str, float], float]  # values, and what they are worth

_PEAKS = 3  # half a grid's step goes along with every other one of its own
# Of a staircase's levels each grid has others that move them by the same, but for its size: these
# are tried, too, where they come near the best and that is no chance. Nothing measured sets them.
_ALIASES, _AS_NEAR, _CLEAR_DROP = 10, 0.5, 50.0
_TAIL = 1.0  # roughness that is worth the tail at one point, or more, from a statistic of 6 on


def as_is(drop: float, square: float) -> float:
    """Rate values by the deviance they take away.

    Parameters
    ----------
    drop
        That deviance.
    square
        Deviance of the change itself.
    """
    return drop


def matched(drop: float, square: float) -> float:
    """Rate values by what their change would take away, or a smaller one along it.

    Between the right value and its neighbours on a grid a jagged change does more harm than good.
    A larger one would be that of a coarser grid.

    Parameters
    ----------
    drop, square
        As in `as_is`.
    """
    if square <= 0.0:
        return 0.0
    along = max(0.5 * (drop + square), 0.0)
    return along**2 / square if along < square else drop


def charged(turned: float, reached: float) -> float:
    """Roughness to charge an effect for whose shape is its size.

    A little of it lies at the beginning, where all looks alike, and must not pay for the rest of
    the way: half of the level is kept for the first radian.

    Parameters
    ----------
    turned
        Angle that the change has turned by over the whole scan, in rad.
    reached
        The same up to the best shape.
    """
    if turned <= 1.0:
        return turned
    return 2.0 * (1.0 if reached <= 1.0 else turned) + _TAIL


def peaks(tried: Sequence[Rated]) -> list[Rated]:
    """Return the best of what was tried in turn, without the neighbours of those before.

    Parameters
    ----------
    tried
        Values along a scan.
    """
    left = np.array([worth for _, worth in tried])
    near = max(_AS_NEAR * float(np.max(left, initial=0.0)), _CLEAR_DROP)
    found: list[Rated] = []
    for _ in range(min(_ALIASES, left.size)):
        k = int(np.argmax(left))
        if left[k] <= (0.0 if len(found) < _PEAKS else near):
            break
        found.append(tried[k])
        left[max(k - 1, 0) : k + 2] = 0.0
    return found
