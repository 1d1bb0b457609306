"""Two wires are swapped: those of the encoder's channels, or those of the drive voltages."""

from dataclasses import replace
from typing import ClassVar

from hil_sim.defects.defect import Defect
from hil_sim.defects.paths import CountPath, DrivePath
from hil_sim.signals import Drive, Samples


class _Swapped:
    """Counts down what passes upward: the decoder takes every edge for one of the other way."""

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


class SwappedOutputs(Defect):
    """Amplifiers A and B drive each other's electrodes: what led by φ lags by it."""

    mechanism: ClassVar[str] = "swapped_outputs"
    cause: ClassVar[str] = "swapped_channels"
    unit: ClassVar[str] = ""
    typical: ClassVar[float] = 1.0

    def drive_path(self) -> DrivePath:
        """Return the crossed path."""

        def formed(_time_s: float, drive: Drive) -> Drive:
            crossed = {"amplitude_a": drive.amplitude_b, "amplitude_b": drive.amplitude_a}
            return replace(drive, phase_deg=-drive.phase_deg, **crossed)

        return DrivePath(formed)
