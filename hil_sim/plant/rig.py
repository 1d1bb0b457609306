"""A motor under a drive, whose turning is read from the disc as a bench does."""

from dataclasses import dataclass

import numpy as np

from hil_sim.plant.motor_plant import MotorPlant
from hil_sim.plant.parameters import PlantParameters
from hil_sim.signals import Drive

_RATE_HZ = 20_000.0


@dataclass(frozen=True, slots=True)
class OperatingPoint:
    """Where a characteristic is measured.

    Parameters
    ----------
    frequency_hz
        Of the drive.
    torque_nm
        Of the brake.
    """

    frequency_hz: float = 41_000.0
    torque_nm: float = 0.0


class Rig:
    """A motor under a drive, whose turning is read from the disc.

    Parameters
    ----------
    parameters
        The motor.
    point
        Frequency and load.
    """

    def __init__(self, parameters: PlantParameters, point: OperatingPoint):
        self._plant = MotorPlant(parameters)
        self._point = point
        self._n_samples = 0
        self._rad_per_count = 2.0 * np.pi / (4 * parameters.disc.lines)
        self._position = 0
        self._plant.set_load(0.0, point.torque_nm)
        self.temperature_c = parameters.thermal.ambient_c

    def drive(self, phase_deg: float, amplitude: float = 1.0) -> None:
        """Change the drive now.

        Parameters
        ----------
        phase_deg
            Phase shift.
        amplitude
            Of both voltages.
        """
        drive = Drive(self._point.frequency_hz, phase_deg, amplitude, amplitude)
        self._plant.drive(self._n_samples / _RATE_HZ, drive)

    def turn(self, duration_s: float) -> float:
        """Wait, and return by how much the disc has turned.

        Parameters
        ----------
        duration_s
            Time to wait.

        Returns
        -------
        float
            Angle in rad.
        """
        n_samples = round(duration_s * _RATE_HZ)
        samples = self._plant.sample(n_samples, _RATE_HZ)
        self._n_samples += n_samples
        self.temperature_c = samples.temperature_c
        turned = int(samples.position[-1]) - self._position
        self._position += turned
        return turned * self._rad_per_count

    def speed(self, settle_s: float = 0.05, average_s: float = 0.1) -> float:
        """Let the speed settle and return its average.

        Parameters
        ----------
        settle_s
            Time before the average.
        average_s
            Time of the average.

        Returns
        -------
        float
            Speed in rad/s.
        """
        if settle_s:
            self.turn(settle_s)
        return self.turn(average_s) / average_s
