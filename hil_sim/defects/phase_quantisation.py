"""The lowest bits of generator B's phase register do not hold: they read as zero."""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import DrivePath
from hil_sim.signals import Drive

_REGISTER_BITS = 12
_MOST_MISSING = 8


class MissingPhaseBits(Defect):
    """The lowest `size` bits of the 12-bit phase register are missing."""

    mechanism: ClassVar[str] = "missing_phase_bits"
    cause: ClassVar[str] = "phase_quantisation"
    unit: ClassVar[str] = "bits"
    typical: ClassVar[float] = 1.0
    most: ClassVar[float] = float(_REGISTER_BITS)

    @classmethod
    def of_strength(cls, strength: float, rng: np.random.Generator) -> Defect:
        """Draw the mechanism: a bit doubles the effect; see `Defect.of_strength`.

        Parameters
        ----------
        strength
            Root mean square of the effect over the noise of a window.
        rng
            Not used: nothing else is free.
        """
        bits = round(cls.typical + math.log2(strength))
        return cls(float(min(max(bits, 1), _MOST_MISSING)))

    def drive_path(self) -> DrivePath:
        """Return the short register."""
        missing_bits, steps = int(self.size), 1 << _REGISTER_BITS

        def formed(_time_s: float, drive: Drive) -> Drive:
            word = round(drive.phase_deg * steps / 360.0) % steps
            kept = word >> missing_bits << missing_bits
            signed = kept - steps if kept >= steps // 2 else kept
            return replace(drive, phase_deg=signed * 360.0 / steps)

        return DrivePath(formed, in_register=True)
