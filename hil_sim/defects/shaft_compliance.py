"""A soft coupling with a weight behind it: the shaft swings after every step."""

import math
from collections import deque
from typing import ClassVar, NamedTuple

from hil_sim.defects.defect import Defect
from hil_sim.plant.rotor import ShaftLoad

_FREQUENCY_HZ = 25.0
_DAMPING = 0.05
_LONGEST_STEP_S = 1e-3
_FORGOTTEN_S = 2.0
_KEPT = 64


class _Swing(NamedTuple):
    """The weight behind the coupling, and the shaft, at an instant."""

    time_s: float = 0.0
    shaft_rad: float = 0.0
    angle_rad: float = 0.0
    speed_rad_s: float = 0.0


class _Absorber:
    """A weight on a torsion spring; steps that are done again go back in its history."""

    pull_bound_nm = 0.0

    def __init__(self, inertia_kg_m2: float):
        omega = 2.0 * math.pi * _FREQUENCY_HZ
        self._inertia = inertia_kg_m2
        self._stiffness = omega**2
        self._damping = 2.0 * _DAMPING * omega
        self._history: deque[_Swing] = deque([_Swing()], maxlen=_KEPT)

    def torques_nm(
        self, time_s: float, angle_rad: float, speed_rad_s: float
    ) -> tuple[float, float]:
        while len(self._history) > 1 and self._history[-1].time_s > time_s:
            self._history.pop()
        swing = self._moved(self._history[-1], time_s, angle_rad, speed_rad_s)
        self._history.append(swing)
        self.pull_bound_nm = abs(self._pull(swing, 0.0))
        return self._pull(swing, speed_rad_s), 0.0

    def _pull(self, swing: _Swing, speed_rad_s: float) -> float:
        twist = swing.angle_rad - swing.shaft_rad
        slip = swing.speed_rad_s - speed_rad_s
        return self._inertia * (self._stiffness * twist + self._damping * slip)

    def _moved(self, last: _Swing, time_s: float, shaft_rad: float, shaft_rad_s: float) -> _Swing:
        """Let the weight follow the shaft, whose angle is taken as straight in between."""
        elapsed_s = time_s - last.time_s
        if elapsed_s > _FORGOTTEN_S:
            return _Swing(time_s, shaft_rad, shaft_rad, shaft_rad_s)
        steps = max(1, math.ceil(elapsed_s / _LONGEST_STEP_S - 1e-6))
        step_s = elapsed_s / steps
        angle, speed, shaft = last.angle_rad, last.speed_rad_s, last.shaft_rad
        mean_rad_s = (shaft_rad - last.shaft_rad) / elapsed_s if elapsed_s > 0.0 else 0.0
        for _ in range(steps):
            accelerated = self._stiffness * (shaft - angle) + self._damping * (mean_rad_s - speed)
            speed += accelerated * step_s
            angle += speed * step_s
            shaft += mean_rad_s * step_s
        return _Swing(time_s, shaft_rad, angle, speed)


class SoftCoupling(Defect):
    """Behind a soft coupling hangs `size` per cent of the motor's own moment of inertia."""

    mechanism: ClassVar[str] = "soft_coupling"
    cause: ClassVar[str] = "shaft_compliance"
    unit: ClassVar[str] = "%"
    typical: ClassVar[float] = 3.0
    most: ClassVar[float] = 10_000.0  # beyond 20 000 the rotor's steps are too long

    def shaft_load(self) -> ShaftLoad:
        """Return coupling and weight, its moment a share of the default motor's 0.265 g·m²."""
        return _Absorber(0.01 * self.size * 2.65e-4)
