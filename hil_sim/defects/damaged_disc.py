"""A scratch across the disc: the sensor sees no lines there, and neither channel changes."""

from typing import ClassVar

import numpy as np

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import CountPath
from hil_sim.signals import Samples

# HEDS-9040 on the testbed's disc of 500 lines, decoded four times.
_COUNTS_PER_LINE, _COUNTS_PER_REV = 4, 2000
_SCRATCHED_AT = 730  # counts ahead of where the shaft starts


class _Scratch:
    """Counts of a revolution of which some lines are gone; both ways, and for good."""

    def __init__(self, lines: int):
        self._gone = _COUNTS_PER_LINE * lines

    def passed(self, samples: Samples, sample_rate_hz: float) -> Samples:
        turns, within = np.divmod(samples.position - _SCRATCHED_AT, _COUNTS_PER_REV)
        gone = self._gone * (turns + 1) + np.minimum(within, self._gone)
        # The shaft starts in the turn before.
        shown = samples.position - gone
        return Samples(shown, samples.index_pulses, samples.temperature_c)


class ScratchedDisc(Defect):
    """A scratch as wide as `size` of the disc's lines."""

    mechanism: ClassVar[str] = "scratched_disc"
    cause: ClassVar[str] = "damaged_disc"
    unit: ClassVar[str] = "lines"
    typical: ClassVar[float] = 1.0
    most: ClassVar[float] = _COUNTS_PER_REV / _COUNTS_PER_LINE

    @classmethod
    def of_strength(cls, strength: float, rng: np.random.Generator) -> Defect:
        """Draw the mechanism; a scratch takes a line at least. See `Defect.of_strength`.

        Parameters
        ----------
        strength
            Root mean square of the effect over the noise of a window.
        rng
            Not used: nothing else is free.
        """
        return cls(max(round(cls.typical * strength), 1))

    def count_path(self, seed: int) -> CountPath:
        """Return the scratch.

        Parameters
        ----------
        seed
            Not used: it is always there.
        """
        return _Scratch(round(self.size))
