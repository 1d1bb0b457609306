"""What the index pulse, once a revolution, says about the counts between two of its passes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from usmbench.errors import DaqError
from usmbench.instruments.samples import SampleBlock


@dataclass(frozen=True, slots=True)
class IndexPass:
    """The last index pulse of a block.

    Parameters
    ----------
    position
        Unwrapped position at the pulse, in counts.
    direction
        +1 or -1: the direction of the last count up to the pulse.
    pulses
        Pulses in the block.
    steady
        Whether every count since the previous pulse went in `direction`.
    step
        Counts between the sample that showed the pulse and the one before.
    """

    position: int
    direction: int
    pulses: int
    steady: bool
    step: int


@dataclass(frozen=True, slots=True)
class IndexState:
    """Where the index was last, for each direction of motion.

    The pulse rises at one end of the index mark going up and at the other going down, so each
    direction is compared with itself.

    Parameters
    ----------
    up, down
        Position at which the index is expected, in counts, or None before the first pass.
    last
        Direction of the last pass, 0 before the first.
    """

    up: int | None = None
    down: int | None = None
    last: int = 0


def check_index(
    state: IndexState, passed: IndexPass, counts_per_rev: int
) -> tuple[IndexState, int | None]:
    """Hold the counts since the last pass in the same direction against whole revolutions.

    A pass within one count of where it was expected leaves the expectation alone, so that counts
    lost one by one add up until they show; a larger discrepancy is reported once.

    Parameters
    ----------
    state
        What is known from the passes before.
    passed
        The new pass.
    counts_per_rev
        Counts of one revolution, as the bench file says.

    Returns
    -------
    IndexState
        What to carry to the next pass.
    int or None
        Counts too many (positive going up) since the last pass; 0 within the sampling instant;
        None on the first pass in a direction, which has nothing to be compared with.
    """
    key = "up" if passed.direction > 0 else "down"
    reference: int | None = getattr(state, key)
    if reference is None:
        return replace(state, last=passed.direction, **{key: passed.position}), None
    travelled = passed.position - reference
    # A shaft that turned round upon the mark is steady since a pulse of the other direction.
    steady = passed.steady and state.last == passed.direction
    turns = passed.direction * passed.pulses if steady else round(travelled / counts_per_rev)
    error = travelled - turns * counts_per_rev
    if abs(error) <= max(1, abs(passed.step)):
        expected = reference + turns * counts_per_rev
        return replace(state, last=passed.direction, **{key: expected}), 0
    # What is missing is missing in both directions.
    other = "down" if key == "up" else "up"
    known: int | None = getattr(state, other)
    moved = None if known is None else known + error
    return IndexState(last=passed.direction, **{key: passed.position, other: moved}), error


@dataclass(frozen=True, slots=True)
class CountsPerRev:
    """Counts of one revolution, as the index pulse measures them.

    Parameters
    ----------
    counts
        Median over the revolutions.
    spread
        Largest less smallest; more than 2 means that counts come and go.
    revolutions
        Number of whole revolutions it was measured over.
    """

    counts: int
    spread: int
    revolutions: int


def measure_counts_per_rev(blocks: Sequence[SampleBlock], counter_bits: int) -> CountsPerRev:
    """Count from index pulse to index pulse while the shaft turns one way.

    Parameters
    ----------
    blocks
        Blocks of one acquisition, in order and without a gap.
    counter_bits
        Width of the counter: it wraps at 2**counter_bits.

    Returns
    -------
    CountsPerRev
        What a revolution counts; positive whichever way the shaft turned.

    Raises
    ------
    usmbench.errors.DaqError
        No index is wired, or the shaft made no whole revolution in one direction.
    """
    indices = [block.index_counts for block in blocks if block.index_counts is not None]
    if len(indices) < len(blocks) or not blocks:
        raise DaqError("no index pulses are counted; set daq.index_counter to where they are wired")
    pulses = np.concatenate(indices)
    # The last blocks may still wait for their index.
    counts = np.concatenate([block.counts for block in blocks])[: len(pulses)]
    half = 1 << (counter_bits - 1)
    steps = ((np.diff(counts) + half) & (2 * half - 1)) - half
    position = np.append(0, np.cumsum(steps))
    travelled = np.append(0, np.cumsum(np.abs(steps)))
    at = np.flatnonzero(np.diff(pulses) == 1) + 1
    turns, way = np.diff(position[at]), np.diff(travelled[at])
    # Without a reversal in between, and not the two ends of the mark passed by turning on it.
    whole = np.abs(turns[(np.abs(turns) == way) & (way > 1)])
    if not len(whole):
        raise DaqError(
            f"{len(at)} index pulses and no whole revolution between two of them; "
            "turn the shaft at least two revolutions one way, and look at the index wire"
        )
    return CountsPerRev(round(float(np.median(whole))), int(np.ptp(whole)), len(whole))
