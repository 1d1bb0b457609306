"""The card's sample clock: takes samples from the testbed, keeps them until they are read."""

import math
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from hil_sim.signals import Samples


class SampleFeed(Protocol):
    """What the card's inputs are wired to; `hil_sim.sample_feed.SampleFeed` is one."""

    @property
    def time_s(self) -> float:
        """Simulated time of the end of the samples taken."""

    def start(self) -> None:
        """Begin an acquisition: sample 0 is the first one after this call."""

    def stop(self) -> None:
        """End an acquisition; safe to call twice."""

    def acquire(self, n_samples: int, sample_rate_hz: float) -> Samples:
        """Return the next `n_samples` and move simulated time on by as much."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """Samples that were taken at one go.

    Parameters
    ----------
    first
        Number of the first, since the clock started.
    samples
        The samples.
    """

    first: int
    samples: Samples

    @property
    def end(self) -> int:
        """Number of the sample after the last."""
        return self.first + len(self.samples.position)


class SampleClock:
    """Ticks with the wall clock, or in lock step as its samples are read.

    Parameters
    ----------
    feed
        Where the samples come from.
    lock_step
        Whether time stands still until samples are read.
    now_s
        The wall clock.
    """

    def __init__(
        self, feed: SampleFeed, *, lock_step: bool, now_s: Callable[[], float] = time.monotonic
    ):
        self.running = False
        self.taken = 0
        self._feed = feed
        self._lock_step = lock_step
        self._now_s = now_s
        self._rate_hz = 1.0
        self._started_s = 0.0
        self._chunks: deque[Chunk] = deque()

    def time_s(self, sample: int) -> float:
        """Return the simulated time at which a sample's interval begins.

        Parameters
        ----------
        sample
            Number of the sample.
        """
        return self._feed.time_s + (sample - self.taken) / self._rate_hz

    def start(self, rate_hz: float) -> None:
        """Start counting samples from 0.

        Parameters
        ----------
        rate_hz
            Samples a second.
        """
        self._feed.start()
        self._rate_hz = rate_hz
        self._started_s = self._now_s()
        self._chunks.clear()
        self.taken = 0
        self.running = True

    def stop(self) -> None:
        """Stop ticking; what was taken stays readable."""
        self.running = False
        self._feed.stop()

    def due(self) -> int:
        """Return how many samples the card has taken by now."""
        if self._lock_step or not self.running:
            return self.taken
        return max(self.taken, math.floor((self._now_s() - self._started_s) * self._rate_hz))

    def wait_s(self, end: int) -> float:
        """Return the time until the samples up to `end` may be taken; inf where it stands still.

        Parameters
        ----------
        end
            Number of the sample after the last.
        """
        if end <= self.taken:
            return 0.0
        if not self.running:
            return math.inf
        if self._lock_step:
            return 0.0
        return max(0.0, self._started_s + end / self._rate_hz - self._now_s())

    def take(self, end: int) -> None:
        """Take the samples up to `end` from the feed.

        Parameters
        ----------
        end
            Number of the sample after the last.
        """
        if end > self.taken:
            samples = self._feed.acquire(end - self.taken, self._rate_hz)
            self._chunks.append(Chunk(self.taken, samples))
            self.taken = end

    def catch_up(self, lag_s: float) -> None:
        """Take all samples due, where more than `lag_s` of them are.

        Parameters
        ----------
        lag_s
            How far behind the clock may be.
        """
        due = self.due()
        if due - self.taken > lag_s * self._rate_hz:
            self.take(due)

    def samples(self, first: int, end: int) -> Samples:
        """Return samples that were taken and are kept.

        Parameters
        ----------
        first, end
            Number of the first sample, and of the one after the last.
        """
        parts = [
            (chunk.samples, slice(max(first - chunk.first, 0), end - chunk.first))
            for chunk in self._chunks
            if chunk.first < end and first < chunk.end
        ]
        if len(parts) == 1:
            samples, part = parts[0]
            return Samples(
                samples.position[part], samples.index_pulses[part], samples.temperature_c
            )
        return Samples(
            np.concatenate([samples.position[part] for samples, part in parts]),
            np.concatenate([samples.index_pulses[part] for samples, part in parts]),
            parts[-1][0].temperature_c,
        )

    def forget(self, before: int) -> None:
        """Drop what nobody reads any more.

        Parameters
        ----------
        before
            Number of the first sample that is still needed.
        """
        while self._chunks and self._chunks[0].end <= before:
            self._chunks.popleft()

    @property
    def oldest(self) -> int:
        """Number of the oldest sample that is kept."""
        return self._chunks[0].first if self._chunks else self.taken
