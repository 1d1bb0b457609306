"""Heating of the stator: two heat capacities in a row, stepped exactly."""

from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from hil_sim.plant.parameters import ThermalParameters
from hil_sim.plant.stator import Vibration
from hil_sim.signals import Drive


class HeatMeter(NamedTuple):
    """Heat made since the last step of the temperatures.

    Parameters
    ----------
    heat_j
        Heat up to `from_s`.
    from_s
        Simulated time since when the loss is constant.
    loss_w
        Loss from then on.
    """

    heat_j: float = 0.0
    from_s: float = 0.0
    loss_w: float = 0.0


class Thermal:
    """Temperatures of stator and housing above the surroundings.

    Parameters
    ----------
    parameters
        Losses, capacities, resistances.
    step_s
        Length of every step.
    """

    def __init__(self, parameters: ThermalParameters, step_s: float):
        p = parameters
        self._parameters = p
        self._step_s = step_s
        to_housing = 1.0 / p.stator_resistance_k_per_w
        to_ambient = 1.0 / p.housing_resistance_k_per_w
        c_1, c_2 = p.stator_capacity_j_per_k, p.housing_capacity_j_per_k
        system = np.array(
            [
                [-to_housing / c_1, to_housing / c_1, 1.0 / c_1],
                [to_housing / c_2, -(to_housing + to_ambient) / c_2, 0.0],
                [0.0, 0.0, 0.0],
            ]
        )
        (self._row_1, self._row_2, _) = expm(system * step_s).tolist()
        self._stator_k = 0.0
        self._housing_k = 0.0
        self.meter = HeatMeter()

    @property
    def warming_k(self) -> float:
        """Stator above the surroundings."""
        return self._stator_k

    @property
    def temperature_c(self) -> float:
        """Stator temperature."""
        return self._parameters.ambient_c + self._stator_k

    def loss_w(self, drive: Drive, vibration: Vibration) -> float:
        """Return the heat that drive and vibration make.

        Parameters
        ----------
        drive
            The voltages.
        vibration
            Of the stator.

        Returns
        -------
        float
            Power in W.
        """
        voltage_squared = 0.5 * (drive.amplitude_a**2 + drive.amplitude_b**2)
        return (
            self._parameters.dielectric_loss_w * voltage_squared
            + self._parameters.vibration_loss_w * vibration.amplitude**2
        )

    def set_loss(self, now_s: float, loss_w: float) -> None:
        """Change the loss.

        Parameters
        ----------
        now_s
            Simulated time.
        loss_w
            Loss from now on.
        """
        heat_j, from_s, before_w = self.meter
        if loss_w != before_w:
            self.meter = HeatMeter(heat_j + before_w * (now_s - from_s), now_s, loss_w)

    def advance(self, now_s: float) -> None:
        """Take the temperatures one step further, with the step's mean loss.

        Parameters
        ----------
        now_s
            Simulated time, one step after the last call's.
        """
        heat_j, from_s, loss_w = self.meter
        power_w = (heat_j + loss_w * (now_s - from_s)) / self._step_s
        self.meter = HeatMeter(0.0, now_s, loss_w)
        stator_k, housing_k = self._stator_k, self._housing_k
        a, b, c = self._row_1
        self._stator_k = a * stator_k + b * housing_k + c * power_w
        a, b, c = self._row_2
        self._housing_k = a * stator_k + b * housing_k + c * power_w
