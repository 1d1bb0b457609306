"""A part of a long record to search on: blocks of it, and every phase that was ever visited."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.data import Dataset, Segment

Array = NDArray[np.float64]
Kept = NDArray[np.bool_]

_BLOCKS, _BLOCK_ROWS = 20, 1500
_PARTS, _FEWEST = 60, 8  # of the range of phases; rows in each, where the record has as many
_AROUND_ROWS = 25  # kept before and after a row that is wanted
_AT_ONCE = 100_000  # rows


def searched_part(data: Dataset, most_rows: int) -> Dataset:
    """Return unbroken parts of the segments: spread over all of them, and at phases seldom seen.

    A curve that is searched without the crests of a multisine goes anywhere there, and all rows
    that show so are outliers to it.

    Parameters
    ----------
    data
        The samples.
    most_rows
        About how many rows to keep; with fewer in all, all are kept.
    """
    if data.n <= most_rows:
        return data
    kept = _blocks(data, most_rows, _BLOCK_ROWS)
    for point in range(len(data.points)):
        own = [k for k, s in enumerate(data.segments) if s.point == point]
        _add_rare([data.segments[k] for k in own], [kept[k] for k in own])
    return _of_kept(data, kept)


def thinned(data: Dataset, most_rows: int, block_rows: int) -> Dataset:
    """Return unbroken parts of the segments, spread over all of them.

    Parameters
    ----------
    data
        The samples.
    most_rows
        About how many rows to keep; with fewer in all, all are kept.
    block_rows
        Rows of an unbroken part at least.
    """
    return data if data.n <= most_rows else _of_kept(data, _blocks(data, most_rows, block_rows))


def _blocks(data: Dataset, most_rows: int, block_rows: int) -> list[Kept]:
    """Mark about as many rows of each segment as are wanted, in blocks spread evenly."""
    marked = []
    for segment in data.segments:
        n, wanted = segment.n, segment.n * most_rows // data.n
        kept = np.zeros(n, dtype=np.bool_)
        blocks = max(1, min(_BLOCKS, wanted // block_rows))
        length = max(block_rows, wanted // blocks)
        for k in range(blocks):
            first = k * n // blocks
            kept[first : first + length] = True
        marked.append(kept)
    return marked


def _add_rare(segments: Sequence[Segment], kept: Sequence[Kept]) -> None:
    """Mark rows at the phases of which too few are marked yet, in place."""
    ends_deg = [(s.phase_deg.min(), s.phase_deg.max()) for s in segments]
    lowest_deg, highest_deg = np.min(ends_deg), np.max(ends_deg)
    edges_deg = np.linspace(lowest_deg, highest_deg, _PARTS + 1)[1:-1]
    part = np.concatenate([_part_of(s.phase_deg, edges_deg) for s in segments])
    marked = np.concatenate(kept)
    have = np.bincount(part[marked], minlength=_PARTS)
    for k in np.flatnonzero(have < _FEWEST):
        rest = np.flatnonzero((part == k) & ~marked)
        marked[rest[np.linspace(0, rest.size - 1, min(rest.size, _FEWEST)).astype(int)]] = True
    ends = np.cumsum([s.n for s in segments])
    for own, with_rare in zip(kept, np.split(marked, ends[:-1]), strict=True):
        for row in np.flatnonzero(with_rare & ~own):
            own[max(row - _AROUND_ROWS, 0) : row + _AROUND_ROWS] = True


def _part_of(phase_deg: Array, edges_deg: Array) -> NDArray[np.uint8]:
    """Part of the range of each row, in a byte: a long record has no room for more."""
    part = np.empty(phase_deg.size, dtype=np.uint8)
    for first in range(0, part.size, _AT_ONCE):
        rows = slice(first, first + _AT_ONCE)
        part[rows] = np.searchsorted(edges_deg, phase_deg[rows])
    return part


def _of_kept(data: Dataset, kept: Sequence[Kept]) -> Dataset:
    """Return the unbroken parts of what is marked."""
    pairs = zip(data.segments, kept, strict=True)
    return replace(data, segments=tuple(part for s, rows in pairs for part in _parts(s, rows)))


def _parts(segment: Segment, kept: Kept) -> Iterator[Segment]:
    """Yield the unbroken parts of what is marked."""
    turns = np.flatnonzero(np.diff(kept, prepend=False, append=False))
    for first, last in list(pairwise(turns.tolist()))[::2]:
        yield segment.part(first, last)
