"""Channels A and B are swapped: the decoder takes every edge for one of the other way."""

from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import CountPath
from hil_sim.signals import Samples


class _Swapped:
    """Counts down what passes upward."""

    def passed(self, samples: Samples, sample_rate_hz: float) -> Samples:
        return Samples(-samples.position, samples.index_pulses, samples.temperature_c)


class SwappedWires(Defect):
    """The encoder's wires A and B are swapped; the size means nothing beyond being there."""

    mechanism: ClassVar[str] = "swapped_wires"
    cause: ClassVar[str] = "swapped_channels"
    unit: ClassVar[str] = ""
    typical: ClassVar[float] = 1.0

    def count_path(self, seed: int) -> CountPath:
        """Return the counter that counts the other way.

        Parameters
        ----------
        seed
            Not used: it has no noise.
        """
        return _Swapped()
