"""What the sweep asks of a data acquisition card: blocks of counter samples, in order."""

from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

INDEX_PERIOD_S: Final = 0.1
"""Time between two reads of the index: what they cost is then a small part of the encoder's."""
NO_INDEX_YET: Final[NDArray[np.int64]] = np.empty(0, np.int64)
"""Index samples of a block that comes between two reads of the index."""


def blocks_per_index_read(samples_per_block: int, sample_rate_hz: float) -> int:
    """Return how many blocks share one read of the index.

    Parameters
    ----------
    samples_per_block
        Samples in each block.
    sample_rate_hz
        Rate of the sample clock.
    """
    return max(1, round(INDEX_PERIOD_S * sample_rate_hz / samples_per_block))


@dataclass(frozen=True, slots=True)
class SampleBlock:
    """Counter samples of one callback (the paper's 1000).

    Parameters
    ----------
    first_sample
        Number of the block's first sample since the start of the acquisition, from 0.
    counts
        Counter values as the card holds them, shape (N,); an N-bit counter wraps.
    index_counts
        Number of index pulses seen up to each of the last M samples, shape (M,), or None without
        an index. The index is read less often than the encoder: a block that brings it brings all
        samples since it was last read, M ≥ N; the blocks between bring none, M = 0.
    temperature_c
        Mean temperature over the block, or None without a sensor.
    """

    first_sample: int
    counts: NDArray[np.int64]
    index_counts: NDArray[np.int64] | None = None
    temperature_c: float | None = None


class SampleSource(Protocol):
    """A running counter task, or the simulated one; used as a context manager that stops it."""

    @property
    def sample_rate_hz(self) -> float:
        """Rate of the sample clock."""

    @property
    def samples_per_block(self) -> int:
        """Samples in each block."""

    @property
    def counter_bits(self) -> int:
        """Width of the counter: it wraps at 2**counter_bits."""

    def start(self) -> None:
        """Start the acquisition; sample 0 is the first one after this call."""

    def next_block(self) -> SampleBlock:
        """Return the next block, waiting for it.

        Raises
        ------
        usmbench.errors.NoDataError
            No block came within the no-data deadline.
        usmbench.errors.DaqError
            The card reported an error; errors from the callback are raised here.
        """

    def samples_acquired(self) -> int:
        """Return how many samples the card has taken by now, read or not."""

    def close(self) -> None:
        """Stop the acquisition and release the card; safe to call twice."""
