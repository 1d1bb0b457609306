"""The counter's input filter swallows pulses that are too short for it."""

import math
from typing import ClassVar

import numpy as np

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import CountPath
from hil_sim.signals import Samples

# HEDS-9040 data sheet (5988-4057EN): pulse width error of 7° of the 180° electrical, typically.
_WIDTH_SPREAD = 7.0 / 180.0
_LINES = 500  # of the disc: each is as wide in every revolution


class _InputFilter:
    """Channel A behind a filter: a pulse that is too short vanishes, and its line with it.

    Without A's pulse the decoder sees B go up and down alone, which adds nothing: four counts are
    lost. How wide a pulse is varies from line to line.
    """

    def __init__(self, shortest_s: float, seed: int):
        rng = np.random.default_rng([seed, 0xF117])
        self._width = 0.5 * (1.0 + _WIDTH_SPREAD * rng.standard_normal(_LINES))
        self._shortest_s = shortest_s
        self._start_s = 0.0
        self._since_s = -math.inf
        self._line: int | None = None
        self._lost = 0

    def passed(self, samples: Samples, sample_rate_hz: float) -> Samples:
        line = samples.position >> 2
        before = int(line[0]) if self._line is None else self._line
        step = np.diff(line, prepend=before)
        at = np.flatnonzero(step)
        lost = np.zeros(line.size, dtype=np.int64)
        if at.size:
            times_s = self._start_s + at / sample_rate_hz
            since_s = np.diff(times_s, prepend=self._since_s)
            width = self._width[line[at] % _LINES]
            # What passes between two samples is as fast as the samples can tell.
            too_short = since_s / np.abs(step[at]) * width < self._shortest_s
            lost[at] = np.where(too_short, 4 * step[at], 0)
            self._since_s = float(times_s[-1])
        self._line = int(line[-1])
        self._start_s += line.size / sample_rate_hz
        lost = self._lost + np.cumsum(lost)
        self._lost = int(lost[-1])
        return Samples(samples.position - lost, samples.index_pulses, samples.temperature_c)


class SlowInputFilter(Defect):
    """The filter of channel A lets no pulse through that is shorter than `size` microseconds."""

    mechanism: ClassVar[str] = "slow_input_filter"
    cause: ClassVar[str] = "missed_counts"
    unit: ClassVar[str] = "µs"
    typical: ClassVar[float] = 560.0

    @classmethod
    def of_strength(cls, strength: float, rng: np.random.Generator) -> Defect:
        """Draw the mechanism so that it bites at the highest speeds; see `Defect.of_strength`.

        Parameters
        ----------
        strength
            Root mean square of the effect over the noise of a window.
        rng
            Not used: nothing else is free.
        """
        return cls(cls.typical * (1.0 + 0.03 * math.log(strength)))

    def count_path(self, seed: int) -> CountPath:
        """Return the filter.

        Parameters
        ----------
        seed
            Seed of the widths of the lines.
        """
        return _InputFilter(1e-6 * self.size, seed)
