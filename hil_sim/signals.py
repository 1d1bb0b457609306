"""What passes between the machines of the testbed."""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Drive:
    """The two drive voltages, as the generators produce them.

    Parameters
    ----------
    frequency_hz
        Frequency of both voltages.
    phase_deg
        Phase of generator B against generator A.
    amplitude_a, amplitude_b
        Amplitudes relative to nominal; 0 where the output is off.
    """

    frequency_hz: float = 0.0
    phase_deg: float = 0.0
    amplitude_a: float = 0.0
    amplitude_b: float = 0.0

    def scaled(self, ratio: float) -> "Drive":
        """Return the drive with both amplitudes multiplied.

        Parameters
        ----------
        ratio
            Factor.
        """
        return replace(
            self, amplitude_a=ratio * self.amplitude_a, amplitude_b=ratio * self.amplitude_b
        )


@dataclass(frozen=True, slots=True)
class Samples:
    """What the encoder and the sensor show at each tick of the sample clock.

    Parameters
    ----------
    position
        Quadrature count (X4) since the start, signed and unwrapped, shape (N,).
    index_pulses
        Index pulses passed since the start, in either direction, shape (N,).
    temperature_c
        Stator temperature at the last sample.
    """

    position: NDArray[np.int64]
    index_pulses: NDArray[np.int64]
    temperature_c: float


class Plant(Protocol):
    """Motor, shaft, disc and sensor: everything between the drive voltages and the counter."""

    def drive(self, time_s: float, drive: Drive) -> None:
        """Change the drive voltages at `time_s`, which is not before any earlier call's."""

    def sample(self, n_samples: int, sample_rate_hz: float) -> Samples:
        """Return the next `n_samples` at the given rate and move time on by as much."""

    def set_load(self, time_s: float, torque_nm: float) -> None:
        """Change the load torque at `time_s`."""
