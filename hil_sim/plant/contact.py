"""The friction contact between the stator's wave crests and the rotor.

Two things happen in it. The travelling part of the wave drags the rotor towards the surface speed
of its crests with a torque that grows with slip and saturates. The standing part holds it: its
crests stand where the surface does not move sideways, so they clamp. Vibration frees the contact
(ultrasonic reduction of friction), steeply above a threshold amplitude.
"""

import math
from typing import NamedTuple

from hil_sim.plant.parameters import ContactParameters
from hil_sim.plant.stator import Vibration


class Grip(NamedTuple):
    """What a vibration of the stator does to the rotor.

    Parameters
    ----------
    surface_speed_rad_s
        Speed towards which the crests drag the rotor.
    traction_limit_nm
        Largest torque of the drag.
    traction_slip_rad_s
        Slip at which tanh reaches 0.76 of that torque.
    clamp_nm
        Friction torque that the vibration leaves against any motion.
    """

    surface_speed_rad_s: float
    traction_limit_nm: float
    traction_slip_rad_s: float
    clamp_nm: float


class Contact:
    """Stateless law of the contact.

    Parameters
    ----------
    parameters
        The friction.
    """

    def __init__(self, parameters: ContactParameters):
        self._parameters = parameters

    def grip(self, vibration: Vibration) -> Grip:
        """Return what a vibration does to the rotor.

        Parameters
        ----------
        vibration
            Of the stator.

        Returns
        -------
        Grip
            Surface speed V·a·s with amplitude a and travelling share s (times the backward ratio
            where s is negative); clamping torque
            C·exp(−(a/a_r)^p)·(1 − s²·(1 − exp(−(a/a_l)²))), where 1 − s² is the standing share.
        """
        p = self._parameters
        amplitude, share = vibration
        frozen = math.exp(-((amplitude / p.release_amplitude) ** p.release_exponent))
        teeth = 1.0 if share > 0.0 else p.backward_ratio
        lifted = -math.expm1(-((amplitude / p.lift_amplitude) ** 2))
        return Grip(
            surface_speed_rad_s=p.speed_per_amplitude_rad_s * amplitude * share * teeth,
            traction_limit_nm=p.traction_limit_nm,
            traction_slip_rad_s=p.traction_slip_rad_s,
            clamp_nm=p.clamp_limit_nm * frozen * (1.0 - share * share * lifted),
        )


def traction(grip: Grip, speed_rad_s: float) -> tuple[float, float]:
    """Return the drag on the rotor and its slope.

    Parameters
    ----------
    grip
        Of the contact.
    speed_rad_s
        Of the rotor.

    Returns
    -------
    tuple of float
        Torque in N·m and its derivative by speed in N·m·s/rad, which is never positive.
    """
    surface_speed_rad_s, limit_nm, slip_rad_s, _ = grip
    bite = math.tanh((surface_speed_rad_s - speed_rad_s) / slip_rad_s)
    return limit_nm * bite, (bite * bite - 1.0) * limit_nm / slip_rad_s
