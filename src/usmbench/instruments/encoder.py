"""From counter samples to motion: one window of angle and speed for each block."""

from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import DaqError
from usmbench.instruments.edge_timing import EDGES_KEPT, fraction_passed
from usmbench.instruments.index_watch import IndexWatch, watch_index
from usmbench.instruments.samples import SampleBlock

_NO_EDGES: NDArray[np.float64] = np.empty(0)


@dataclass(frozen=True, slots=True)
class EncoderGeometry:
    """What turns counter samples into angle and time.

    Parameters
    ----------
    counts_per_rev
        Counts of one revolution: four times the lines at X4, the lines at X1.
    counter_bits
        Width of the counter: it wraps at 2**counter_bits.
    sign
        +1 or -1: the direction in which the counter runs at positive phase.
    sample_rate_hz
        Rate of the sample clock.
    """

    counts_per_rev: int
    counter_bits: int
    sign: int
    sample_rate_hz: float

    @property
    def rad_per_count(self) -> float:
        """Angle of one count of the counter, with the encoder's sign."""
        return self.sign * 2.0 * pi / self.counts_per_rev


@dataclass(frozen=True, slots=True)
class EncoderState:
    """What one block leaves for the next; a new one starts a run.

    Parameters
    ----------
    next_sample
        Number of the sample that must come next, or None before the first block.
    last_count
        Last counter value, as the card held it.
    position
        Unwrapped position at that sample, in counts of the counter from the run's first sample.
    estimate
        Position estimated between the edges, in counts; within `position` and `position` + 1.
    edge_samples
        Times of the last edges, all crossed in `edge_step`'s direction, in samples, oldest first,
        shape (E,).
    edge_step
        +1 or -1: direction of those edges; 0 when there are none.
    index
        What the index pulse has shown.
    """

    next_sample: int | None = None
    last_count: int = 0
    position: int = 0
    estimate: float = 0.5
    edge_samples: NDArray[np.float64] = field(default_factory=lambda: _NO_EDGES)
    edge_step: int = 0
    index: IndexWatch = field(default_factory=IndexWatch)


@dataclass(frozen=True, slots=True)
class WindowMotion:
    """Motion over one window: from the previous block's last sample to this block's last.

    Parameters
    ----------
    angle_rad
        Angle at the window's end, unwrapped, from the first sample of the run, in whole counts.
    average_rad_s
        The paper's speed: counts of the window times the angle of one, over its duration.
    edge_timed_rad_s
        Average speed of the same window with the position between edges estimated at both ends.
        Summed over windows it stays within one count of `angle_rad`.
    counts
        Counts of the window, positive for positive speed.
    window_s
        Duration: N samples, one less in the first block, which has no sample before it.
    index_error_counts
        Counts too many (positive for positive speed) since the last pass of the index in the same
        direction; None where this block brought no pass that could be compared. It comes with the
        block that brings the index, up to `usmbench.instruments.samples.INDEX_PERIOD_S` late.
    """

    angle_rad: float
    average_rad_s: float
    edge_timed_rad_s: float
    counts: int
    window_s: float
    index_error_counts: int | None


def decode(
    state: EncoderState, block: SampleBlock, geometry: EncoderGeometry
) -> tuple[EncoderState, WindowMotion]:
    """Turn one block of counter samples into the motion of one window.

    Parameters
    ----------
    state
        What the block before left; ``EncoderState()`` at the start of a run.
    block
        The samples, following without a gap on those before.
    geometry
        The encoder and the clock.

    Returns
    -------
    EncoderState
        To be handed in with the next block.
    WindowMotion
        The window that ends with the block's last sample.

    Raises
    ------
    usmbench.errors.DaqError
        The block does not follow on the one before.
    """
    first = state.next_sample is None
    if first:
        state = EncoderState(block.first_sample, int(block.counts[0]))
    elif state.next_sample != block.first_sample:
        raise DaqError(
            f"samples {state.next_sample} to {block.first_sample} of the counter are missing, "
            "the angle is lost; lower sample_rate_hz or raise samples_per_average, and begin again"
        )
    counts = block.counts
    n_samples = len(counts)
    where, steps = _edges(state.last_count, counts, geometry.counter_bits)
    # Edge k lies between samples k - 1 and k of the block.
    times: NDArray[np.float64] = where + np.float64(block.first_sample - 0.5)
    moved = sum(steps)
    position = state.position + moved
    edge_samples, edge_step = _latest_run(state, times, steps)
    end_sample = block.first_sample + n_samples - 1
    estimate = _estimate(state, position, edge_samples, edge_step, end_sample)
    begin = state.estimate
    if first and steps:
        begin = _backwards(times, steps, block.first_sample)
    index, error = watch_index(state.index, block, (times, steps), geometry.counts_per_rev)
    duration_s = (n_samples - first) / geometry.sample_rate_hz
    rad_per_count = geometry.rad_per_count
    motion = WindowMotion(
        angle_rad=position * rad_per_count,
        average_rad_s=moved * rad_per_count / duration_s if duration_s else 0.0,
        edge_timed_rad_s=(estimate - begin) * rad_per_count / duration_s if duration_s else 0.0,
        counts=geometry.sign * moved,
        window_s=duration_s,
        index_error_counts=None if error is None else geometry.sign * error,
    )
    following = EncoderState(
        end_sample + 1,
        int(counts[-1]),
        position,
        estimate,
        edge_samples,
        edge_step,
        index,
    )
    return following, motion


def _edges(
    last_count: int, counts: NDArray[np.int64], counter_bits: int
) -> tuple[NDArray[np.intp], list[int]]:
    """Return where in the block the counter changed, and by how much, wraps undone."""
    (before,) = (counts[1:] != counts[:-1]).nonzero()
    where = before + 1
    changes = counts[where] - counts[before]
    if counts[0] != last_count:
        where = np.concatenate(([0], where))
        changes = np.concatenate(([counts[0] - last_count], changes))
    half = 1 << (counter_bits - 1)
    steps: list[int] = (((changes + half) & (2 * half - 1)) - half).tolist()
    return where, steps


def _latest_run(
    state: EncoderState, times: NDArray[np.float64], steps: list[int]
) -> tuple[NDArray[np.float64], int]:
    """Return the last edges that went one way count by count, at most `EDGES_KEPT`."""
    if not steps:
        return state.edge_samples, state.edge_step
    step = steps[-1]
    if abs(step) != 1:
        return _NO_EDGES, 0
    recent = steps[-EDGES_KEPT:]
    n = 1
    while n < len(recent) and recent[-1 - n] == step:
        n += 1
    run = times[-n:]
    if n == len(steps) and step == state.edge_step:
        run = np.concatenate((state.edge_samples[n - EDGES_KEPT :] if n < EDGES_KEPT else [], run))
    return run, step


def _estimate(
    state: EncoderState,
    position: int,
    edge_samples: NDArray[np.float64],
    edge_step: int,
    end_sample: int,
) -> float:
    """Return the position between the edges at the window's end, in counts."""
    if not edge_step:
        return state.estimate if position == state.position else position + 0.5
    crossed = position if edge_step > 0 else position + 1
    fraction = fraction_passed(edge_samples, end_sample)
    if edge_samples is state.edge_samples:
        # No edge in this window: no faster than one count in the time since the last.
        before = abs(state.estimate - crossed)
        elapsed = end_sample - float(edge_samples[-1])
        n_samples = end_sample + 1 - (state.next_sample or 0)
        fraction = min(max(fraction, before), before + n_samples / elapsed, 1.0)
    return crossed + edge_step * fraction


def _backwards(times: NDArray[np.float64], steps: list[int], first_sample: int) -> float:
    """Return the position at the run's first sample, estimated from the edges after it."""
    step = steps[0]
    if abs(step) != 1:
        return 0.5
    recent = steps[:EDGES_KEPT]
    n = 1
    while n < len(recent) and recent[n] == step:
        n += 1
    fraction = fraction_passed(-times[:n][::-1], -first_sample)
    return 1.0 - fraction if step > 0 else fraction
