"""The rotor: inertia under traction, dry friction and load, sticking and slipping exactly.

In motion, J·dω/dt = T_traction(ω) + T_noise + T_weight − sign(ω)·(T_clamp + T_bearing + T_brake).
Each step takes the torque's slope at its start and follows the linear equation exactly (an
exponential Rosenbrock step). Where the speed comes to zero inside a step, the step ends there and
the rotor stays unless the torque breaks it away.
"""

import math
from typing import NamedTuple

from hil_sim.plant.contact import Grip, traction
from hil_sim.plant.parameters import RotorParameters

_TURN_RAD = 2.0 * math.pi
# Below this the closed forms of the step lose digits and a series is exact to double precision.
_SMALL = 1e-3


class Piece(NamedTuple):
    """A stretch of the shaft's path: a cubic in the time since its start.

    Parameters
    ----------
    start_s
        Simulated time of its start.
    revolutions
        Whole turns at its start.
    angle_rad
        Angle at its start beyond the whole turns, 0…2π.
    speed_rad_s, second_rad_s2, third_rad_s3
        Coefficients of the first, second and third power.
    """

    start_s: float
    revolutions: float
    angle_rad: float
    speed_rad_s: float
    second_rad_s2: float
    third_rad_s3: float


class RotorState(NamedTuple):
    """Where the shaft is and how fast it turns.

    Parameters
    ----------
    speed_rad_s
        Speed.
    revolutions
        Whole turns.
    angle_rad
        Angle beyond the whole turns, 0…2π, so that its precision never fades.
    """

    speed_rad_s: float = 0.0
    revolutions: int = 0
    angle_rad: float = 0.0


class Rotor:
    """The turning parts and the load on them.

    Parameters
    ----------
    parameters
        Inertia, friction, weight.
    """

    def __init__(self, parameters: RotorParameters):
        self._parameters = parameters
        self.state = RotorState()
        self.path: list[Piece] = []
        self.brake_nm = 0.0

    def set_brake(self, torque_nm: float) -> None:
        """Set the load that acts against any motion.

        Parameters
        ----------
        torque_nm
            Torque, at least 0.
        """
        self.brake_nm = torque_nm

    def stays(self, grip: Grip, disturbance_nm: float) -> bool:
        """Return whether the rotor is at rest and no disturbance up to the given one moves it.

        Parameters
        ----------
        grip
            Of the contact.
        disturbance_nm
            Bound of the torque noise's size.

        Returns
        -------
        bool
            True where it stands still.
        """
        if self.state.speed_rad_s != 0.0:
            return False
        pull_nm = traction(grip, 0.0)[0] + self._parameters.weight_nm
        breakaway_nm = self._friction_nm(grip) * self._parameters.breakaway_ratio
        return abs(pull_nm) + disturbance_nm <= breakaway_nm

    def rest(self, start_s: float) -> None:
        """Stand still from `start_s` on; consecutive rests make one piece.

        Parameters
        ----------
        start_s
            Simulated time.
        """
        if not (self.path and self.path[-1][3:] == (0.0, 0.0, 0.0)):
            _, revolutions, angle_rad = self.state
            self.path.append(Piece(start_s, revolutions, angle_rad, 0.0, 0.0, 0.0))

    def advance(self, start_s: float, duration_s: float, grip: Grip, noise_nm: float) -> None:
        """Move on by a step in which grip and noise are constant, adding to the path.

        Parameters
        ----------
        start_s
            Simulated time of the step's start.
        duration_s
            Length of the step.
        grip
            Of the contact.
        noise_nm
            Torque noise.
        """
        push_nm = noise_nm + self._parameters.weight_nm
        friction_nm = self._friction_nm(grip)
        while duration_s > 0.0:
            speed_rad_s = self.state.speed_rad_s
            torque_nm, slope = traction(grip, speed_rad_s)
            torque_nm += push_nm
            if speed_rad_s != 0.0:
                forward = speed_rad_s > 0.0
            elif abs(torque_nm) > friction_nm * self._parameters.breakaway_ratio:
                forward = torque_nm > 0.0
            else:
                self.rest(start_s)
                return
            torque_nm += -friction_nm if forward else friction_nm
            taken_s = self._slide(start_s, duration_s, torque_nm, slope, forward)
            start_s += taken_s
            duration_s -= taken_s

    def _friction_nm(self, grip: Grip) -> float:
        return grip.clamp_nm + self._parameters.bearing_friction_nm + self.brake_nm

    def _slide(
        self, start_s: float, duration_s: float, torque_nm: float, slope: float, forward: bool
    ) -> float:
        """Slide one way for the step, or until the speed is zero; return the time it took."""
        inertia = self._parameters.inertia_kg_m2
        speed_0, revolutions, angle_rad = self.state
        acceleration = torque_nm / inertia
        rate = slope / inertia
        gained, moved = _exponential_step(acceleration, rate, duration_s)
        speed_1 = speed_0 + gained
        if (speed_1 < 0.0) if forward else (speed_1 > 0.0):
            duration_s = min(duration_s, _time_to_rest(speed_0, acceleration, rate))
            _, moved = _exponential_step(acceleration, rate, duration_s)
            speed_1 = 0.0
        turned = speed_0 * duration_s + moved
        if duration_s > 0.0:
            mean = turned / duration_s
            second = (3.0 * mean - 2.0 * speed_0 - speed_1) / duration_s
            third = (speed_0 + speed_1 - 2.0 * mean) / (duration_s * duration_s)
            self.path.append(Piece(start_s, revolutions, angle_rad, speed_0, second, third))
        angle_rad += turned
        if not 0.0 <= angle_rad < _TURN_RAD:
            turns = math.floor(angle_rad / _TURN_RAD)
            revolutions += turns
            angle_rad -= turns * _TURN_RAD
        self.state = RotorState(speed_1, revolutions, angle_rad)
        return duration_s


def _exponential_step(acceleration: float, rate: float, duration_s: float) -> tuple[float, float]:
    """Speed gained, and angle moved by it, where the acceleration decays at a (negative) rate."""
    x = rate * duration_s
    if x > -_SMALL:
        first = 1.0 + x * (0.5 + x * (1.0 / 6.0 + x / 24.0))
        second = 0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0 + x / 120.0))
    else:
        first = math.expm1(x) / x
        second = (first - 1.0) / x
    gained = acceleration * duration_s
    return gained * first, gained * duration_s * second


def _time_to_rest(speed_rad_s: float, acceleration: float, rate: float) -> float:
    """Time after which a slowing rotor's speed is zero."""
    ratio = -speed_rad_s / acceleration
    x = rate * ratio
    return ratio * (math.log1p(x) / x if abs(x) > _SMALL else 1.0 - x * (0.5 - x / 3.0))
