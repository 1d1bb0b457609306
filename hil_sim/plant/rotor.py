"""The rotor: inertia under traction, dry friction and load, sticking and slipping exactly.

In motion, J·dω/dt = T_traction(ω) + T_noise + T_weight − sign(ω)·(T_clamp + T_bearing + T_brake).
Each step takes the torque's slope at its start and follows the linear equation exactly (an
exponential Rosenbrock step). Where the speed comes to zero inside a step, the step ends there and
the rotor stays unless the torque breaks it away.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple, Protocol

from hil_sim.plant.contact import Grip, traction
from hil_sim.plant.parameters import RotorParameters

_TURN_RAD = 2.0 * math.pi
# Below this the closed forms of the step lose digits and a series is exact to double precision.
_SMALL = 1e-3


Piece = tuple[float, int, float, float, float, float]
"""A stretch of the shaft's path, a cubic in the time since its start: start in simulated s, whole
turns and angle (rad, 0…2π) there, then speed (rad/s) and the coefficients of the second and third
power (rad/s², rad/s³). A plain tuple, since twenty are made in every window."""


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


class ShaftLoad(Protocol):
    """What else hangs on the shaft than a brake and a weight."""

    @property
    def pull_bound_nm(self) -> float:
        """Size that the pull never exceeds while the shaft stands still."""

    def torques_nm(
        self, time_s: float, angle_rad: float, speed_rad_s: float
    ) -> tuple[float, float]:
        """Return the pull (positive in the positive direction) and the drag against any motion.

        Asked at the start of every step; a step may be done again from an earlier time.
        """


class Rotor:
    """The turning parts and the load on them.

    Parameters
    ----------
    parameters
        Inertia, friction, weight.
    load
        What else hangs on the shaft, or None.
    """

    def __init__(self, parameters: RotorParameters, load: ShaftLoad | None = None):
        self._parameters = parameters
        self._load = load
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
        if self._load is not None:
            disturbance_nm += self._load.pull_bound_nm
        breakaway_nm = self._friction_nm(grip) * self._parameters.breakaway_ratio
        return abs(pull_nm) + disturbance_nm <= breakaway_nm

    def advance(self, start_s: float, steps: Iterable[tuple[float, float]], grip: Grip) -> None:
        """Move on through steps in which the grip is constant, adding to the path.

        Parameters
        ----------
        start_s
            Simulated time of the first step's start.
        steps
            End in s and torque noise in N·m of each step.
        grip
            Of the contact.
        """
        weight_nm, inertia = self._parameters.weight_nm, self._parameters.inertia_kg_m2
        own_friction_nm = friction_nm = self._friction_nm(grip)
        breakaway_ratio, load = self._parameters.breakaway_ratio, self._load
        speed, revolutions, angle = self.state
        for end_s, noise_nm in steps:
            while start_s < end_s:
                torque_nm, slope = traction(grip, speed)
                torque_nm += weight_nm + noise_nm
                if load is not None:
                    total_rad = revolutions * _TURN_RAD + angle
                    pull_nm, drag_nm = load.torques_nm(start_s, total_rad, speed)
                    torque_nm += pull_nm
                    friction_nm = own_friction_nm + drag_nm
                if speed == 0.0 and abs(torque_nm) <= friction_nm * breakaway_ratio:
                    self._rest(start_s, revolutions, angle)
                    start_s = end_s
                    break
                torque_nm -= math.copysign(friction_nm, speed or torque_nm)
                start, duration_s = start_s, end_s - start_s
                start_s = end_s
                gained, moved = _relax(torque_nm / inertia, slope / inertia, duration_s)
                if speed * (speed + gained) < 0.0:
                    duration_s = _time_to_rest(speed, torque_nm / inertia, slope / inertia)
                    start_s = min(start + duration_s, end_s)
                    _, moved = _relax(torque_nm / inertia, slope / inertia, duration_s)
                    gained = -speed
                if duration_s > 0.0:
                    lag = moved / duration_s
                    second = (3.0 * lag - gained) / duration_s
                    third = (gained - 2.0 * lag) / (duration_s * duration_s)
                    self.path.append((start, revolutions, angle, speed, second, third))
                angle += speed * duration_s + moved
                speed += gained
                if not 0.0 <= angle < _TURN_RAD:
                    turns = math.floor(angle / _TURN_RAD)
                    revolutions += turns
                    angle -= turns * _TURN_RAD
        self.state = RotorState(speed, revolutions, angle)

    def _rest(self, start_s: float, revolutions: int, angle_rad: float) -> None:
        """Stand still from `start_s` on; consecutive rests make one piece."""
        if not (self.path and is_rest(self.path[-1])):
            self.path.append((start_s, revolutions, angle_rad, 0.0, 0.0, 0.0))

    def _friction_nm(self, grip: Grip) -> float:
        return grip.clamp_nm + self._parameters.bearing_friction_nm + self.brake_nm


def is_rest(piece: Piece) -> bool:
    """Return whether the shaft stands still in a piece.

    Parameters
    ----------
    piece
        Of the path.

    Returns
    -------
    bool
        True where nothing moves.
    """
    return piece[3] == 0.0 and piece[4] == 0.0 and piece[5] == 0.0


def _relax(acceleration: float, rate: float, duration_s: float) -> tuple[float, float]:
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
