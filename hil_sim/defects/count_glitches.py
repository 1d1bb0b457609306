"""Noise on an encoder channel: the decoder takes a spike for an edge now and then."""

from typing import ClassVar

import numpy as np

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import CountPath
from hil_sim.signals import Samples


class _Spikes:
    """False counts at random instants, either way, that stay in the count."""

    def __init__(self, rate_hz: float, seed: int):
        self._rng = np.random.default_rng([seed, 0x5B1E])
        self._rate_hz = rate_hz
        self._false = 0

    def passed(self, samples: Samples, sample_rate_hz: float) -> Samples:
        n = samples.position.size
        spikes = self._rng.poisson(self._rate_hz * n / sample_rate_hz)
        false = np.full(n, self._false, dtype=np.int64)
        for _ in range(spikes):
            false[int(self._rng.integers(n)) :] += int(self._rng.choice([-1, 1]))
        self._false = int(false[-1])
        return Samples(samples.position + false, samples.index_pulses, samples.temperature_c)


class Spikes(Defect):
    """A channel takes up `size` spikes a second, each of which counts one."""

    mechanism: ClassVar[str] = "spikes"
    cause: ClassVar[str] = "count_glitches"
    unit: ClassVar[str] = "1/s"
    typical: ClassVar[float] = 0.05
    most: ClassVar[float] = 1e5  # as many as a counter samples

    @classmethod
    def of_strength(cls, strength: float, rng: np.random.Generator) -> Defect:
        """Draw the mechanism: the mean square grows with the rate; see `Defect.of_strength`.

        Parameters
        ----------
        strength
            Root mean square of the effect over the noise of a window.
        rng
            Not used: nothing else is free.
        """
        return cls(cls.typical * strength**2)

    def count_path(self, seed: int) -> CountPath:
        """Return the noisy channel.

        Parameters
        ----------
        seed
            Seed of the spikes.
        """
        return _Spikes(self.size, seed)
