"""Holds the counts against the index pulse, as often as the index is read."""

from dataclasses import dataclass, field
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from usmbench.instruments.index_check import IndexPass, IndexState, check_index
from usmbench.instruments.samples import SampleBlock

Edges = tuple[NDArray[np.float64], list[int]]
"""Times of a block's edges, in samples, shape (E,), and the counts of each."""


@dataclass(frozen=True, slots=True)
class IndexWatch:
    """What is carried from block to block to hold the counts against the index.

    Parameters
    ----------
    position
        Unwrapped position where the index was last read, in counts.
    edges
        The edges of each block since then.
    steady
        +1 or -1: direction of every count since the last index pulse, 0 without counts, None when
        they went both ways; all up to `position`.
    direction
        +1 or -1: direction of the last count up to `position`, 0 before the first.
    pulses
        Last value of the index counter, None before it was read.
    state
        Where the index was last.
    """

    position: int = 0
    edges: tuple[Edges, ...] = ()
    steady: int | None = 0
    direction: int = 0
    pulses: int | None = None
    state: IndexState = field(default_factory=IndexState)


def watch_index(
    watch: IndexWatch, block: SampleBlock, edges: Edges, counts_per_rev: int
) -> tuple[IndexWatch, int | None]:
    """Take one block; where it brings the index, find the last pulse among the edges.

    Parameters
    ----------
    watch
        What the blocks before left.
    block
        The samples.
    edges
        The block's edges.
    counts_per_rev
        Counts of one revolution, as the bench file says.

    Returns
    -------
    IndexWatch
        To be handed in with the next block.
    int or None
        As `usmbench.instruments.index_check.check_index` has it; None as well where no pulse came.
    """
    index_counts = block.index_counts
    if index_counts is None:
        return watch, None
    if edges[1]:
        waiting = (*watch.edges, edges)
        watch = IndexWatch(
            watch.position, waiting, watch.steady, watch.direction, watch.pulses, watch.state
        )
    if not len(index_counts):
        return watch, None
    first_sample = block.first_sample + len(block.counts) - len(index_counts)
    return _hold_against(watch, index_counts, first_sample, counts_per_rev)


def _hold_against(
    watch: IndexWatch, index_counts: NDArray[np.int64], first_sample: int, counts_per_rev: int
) -> tuple[IndexWatch, int | None]:
    """Hold the edges that have waited against the index samples of the same time."""
    steps = list(chain.from_iterable(some for _, some in watch.edges))
    before = int(index_counts[0]) if watch.pulses is None else watch.pulses
    pulses = int(index_counts[-1])
    end = watch.position + sum(steps)
    last = _sign(steps[-1]) if steps else watch.direction
    if pulses == before:
        steady = _one_way(watch.steady, steps)
        return IndexWatch(end, (), steady, last, pulses, watch.state), None
    at_sample = first_sample + int(np.searchsorted(index_counts, pulses))
    upto = sum(int(times.searchsorted(at_sample)) for times, _ in watch.edges)
    step = steps[upto - 1] if upto else 0
    direction = _sign(step) or watch.direction
    after = _one_way(0, steps[upto:])
    if not direction:
        return IndexWatch(end, (), after, last, pulses, watch.state), None
    passed = IndexPass(
        position=watch.position + sum(steps[:upto]),
        direction=direction,
        pulses=pulses - before,
        steady=_one_way(watch.steady, steps[:upto]) == direction,
        step=step,
    )
    state, error = check_index(watch.state, passed, counts_per_rev)
    return IndexWatch(end, (), after, last, pulses, state), error


def _one_way(before: int | None, steps: list[int]) -> int | None:
    """Return the one direction of the steps and of those before, 0 for none, None for both."""
    if not steps or before is None:
        return before
    different = set(steps)
    low, high = min(different), max(different)
    if low < 0 < high:
        return None
    direction = _sign(high)
    return direction if before in (0, direction) else None


def _sign(step: int) -> int:
    return (step > 0) - (step < 0)
