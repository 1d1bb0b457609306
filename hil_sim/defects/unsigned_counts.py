"""Channel B is dead, and the counter has it as its direction: every edge counts up."""

from typing import ClassVar

import numpy as np

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import CountPath
from hil_sim.signals import Samples


class _DeadDirection:
    """Counts what passes, whichever way."""

    def __init__(self) -> None:
        self._seen = 0
        self._shown = 0

    def passed(self, samples: Samples, sample_rate_hz: float) -> Samples:
        edges = np.abs(np.diff(samples.position, prepend=self._seen))
        shown = self._shown + np.cumsum(edges)
        self._seen, self._shown = int(samples.position[-1]), int(shown[-1])
        return Samples(shown, samples.index_pulses, samples.temperature_c)


class DeadDirection(Defect):
    """The direction input of the counter is stuck; the size means nothing beyond being there."""

    mechanism: ClassVar[str] = "dead_direction"
    cause: ClassVar[str] = "unsigned_counts"
    unit: ClassVar[str] = ""
    typical: ClassVar[float] = 1.0

    def count_path(self, seed: int) -> CountPath:
        """Return the counter without a direction.

        Parameters
        ----------
        seed
            Not used: it has no noise.
        """
        return _DeadDirection()
