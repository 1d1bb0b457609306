"""Play in the encoder's coupling: after a reversal the disc waits until the play is used up."""

from typing import ClassVar

import numpy as np

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import CountPath
from hil_sim.signals import Samples


class _Play:
    """The disc is pushed by either flank and rests in between."""

    def __init__(self, play_counts: int):
        self._play = play_counts
        self._shaft = 0
        self._disc = 0

    def passed(self, samples: Samples, sample_rate_hz: float) -> Samples:
        position = samples.position
        steps = np.diff(position, prepend=self._shaft)
        moves = np.flatnonzero(steps)
        # Between two reversals the shaft pushes one flank only.
        reversals = moves[1:][np.diff(np.sign(steps[moves])) != 0]
        shown = np.empty_like(position)
        for part in np.split(np.arange(position.size), reversals):
            here = position[part]
            if here[-1] >= self._shaft:
                shown[part] = np.maximum(self._disc, here - self._play)
            else:
                shown[part] = np.minimum(self._disc, here)
            self._shaft, self._disc = int(here[-1]), int(shown[part[-1]])
        return Samples(shown, samples.index_pulses, samples.temperature_c)


class LooseCoupling(Defect):
    """The encoder's coupling has a play of `size` counts (0.18° each)."""

    mechanism: ClassVar[str] = "loose_coupling"
    cause: ClassVar[str] = "coupling_backlash"
    unit: ClassVar[str] = "counts"
    typical: ClassVar[float] = 1.0

    @classmethod
    def of_strength(cls, strength: float, rng: np.random.Generator) -> Defect:
        """Draw the mechanism in whole counts; see `Defect.of_strength`.

        Parameters
        ----------
        strength
            Root mean square of the effect over the noise of a window.
        rng
            Not used: nothing else is free.
        """
        return cls(float(max(1, round(cls.typical * strength))))

    def count_path(self, seed: int) -> CountPath:
        """Return the play.

        Parameters
        ----------
        seed
            Not used: it has no noise.
        """
        return _Play(int(self.size))
