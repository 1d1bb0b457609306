"""What a gap passes on of a movement to and fro."""

import numpy as np

from usmbench.model.effects.base import Array


def passed_on(moves: Array, gap: float) -> Array:
    """Return what follows of moves behind a gap, which each reversal has to cross first.

    Parameters
    ----------
    moves
        Moves one after the other, shape (N,). At the first of them the gap is closed.
    gap
        Width of the gap, above 0, in the moves' unit.
    """
    moving = np.flatnonzero(moves)
    if moving.size == 0:
        return np.zeros_like(moves)
    way = last_way(moves)
    way[: moving[0]] = way[moving[0]]
    begins = np.flatnonzero(np.diff(way, prepend=np.nan))
    lengths = np.diff(begins, append=way.size)
    whole = np.add.reduceat(np.abs(moves), begins)
    ahead = np.repeat(_ahead(whole, gap), lengths)
    before = np.repeat(np.cumsum(whole) - whole, lengths)
    path = np.cumsum(np.abs(moves)) - before
    follows = np.maximum(path - ahead, 0.0)
    passed = np.diff(follows, prepend=0.0)
    passed[begins] = follows[begins]
    return np.asarray(way * passed)


def _ahead(whole: Array, gap: float) -> Array:
    """Return the path to the other flank at the begin of each way."""
    found, ahead = np.zeros_like(whole), 0.0
    for k, path in enumerate(whole.tolist()):
        found[k] = ahead
        ahead = gap - max(ahead - path, 0.0)
    return found


def last_way(moves: Array) -> Array:
    """Return the sign of the last move that was not 0, shape (N,); 0 before the first.

    Parameters
    ----------
    moves
        Moves one after the other, shape (N,).
    """
    way, rows = np.sign(moves), np.arange(moves.size)
    last = np.maximum.accumulate(np.where(way != 0.0, rows, 0))
    return np.asarray(way[last])
