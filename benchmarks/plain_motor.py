"""A motor of a few lines, and what may be wrong with it.

A curve with a dead zone and a lag: no torque, no slip, no warm-up. It shares nothing with the
simulated testbed nor with the model. A window is averaged over fine steps, or read at its end.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]

FINE = 40
"""Steps a window."""
_GLITCHES = 0.02  # share of windows
_OFF_COUNT = 0.6  # of the highest speed: counts are lost above

CURVES: dict[str, Callable[[Array], Array]] = {
    "smooth": np.tanh,
    "ramp": lambda beyond: np.clip(beyond / 1.3, -1.0, 1.0),
    "exponential": lambda beyond: np.sign(beyond) * -np.expm1(-np.abs(beyond)),
    "steep": lambda beyond: np.sign(beyond) * np.sqrt(np.tanh(np.abs(beyond))),
    "gentle": lambda beyond: np.sign(beyond) * np.tanh(np.abs(beyond)) ** 1.5,
}
"""Speed over the highest, by how many reaches the phase is beyond the dead zone."""
_SATURATING = ("smooth", "ramp", "exponential")  # each starts at a corner


@dataclass(frozen=True, slots=True)
class PlainMotor:
    """A motor.

    Parameters
    ----------
    edges_deg
        Where the dead zone ends on both sides, as sizes; one each, or one a step.
    reach_deg
        How far beyond the speed saturates.
    top_rad_s
        Highest speed; one, or one a step.
    lag_s
        Time constant.
    curve
        How the speed saturates: one of `CURVES`.
    brakes_in
        Share of its time constant that it takes to slow down.
    """

    edges_deg: tuple[float | Array, float | Array]
    reach_deg: float
    top_rad_s: float | Array
    lag_s: float
    curve: str = "smooth"
    brakes_in: float = 1.0

    def settled_rad_s(self, phase_deg: Array) -> Array:
        """Return the settled speed, shape (N,).

        Parameters
        ----------
        phase_deg
            The phase, shape (N,).
        """
        low, high = self.edges_deg
        beyond = np.maximum(phase_deg - high, 0.0) - np.maximum(-phase_deg - low, 0.0)
        settled: Array = self.top_rad_s * CURVES[self.curve](beyond / self.reach_deg)
        return settled


@dataclass(frozen=True, slots=True)
class Wrong:
    """What is wrong with a run, at most one thing.

    Parameters
    ----------
    cause
        Its name; empty for nothing.
    size
        Its size, in the unit of the cause: deg, s, rad/s or a share.
    """

    cause: str = ""
    size: float = 0.0

    def of(self, cause: str) -> float:
        """Return the size of a cause, 0 where it is another.

        Parameters
        ----------
        cause
            The name.
        """
        return self.size if cause == self.cause else 0.0


def motor_of(rng: np.random.Generator) -> PlainMotor:
    """Draw a motor that saturates smoothly.

    Parameters
    ----------
    rng
        Where chance comes from.
    """
    edge_deg = rng.uniform(6.0, 25.0)
    return PlainMotor(
        (edge_deg * rng.uniform(0.9, 1.1), edge_deg),
        rng.uniform(25.0, 60.0),
        rng.uniform(5.0, 13.0),
        rng.uniform(0.0025, 0.0052),
    )


def motor_of_any_curve(rng: np.random.Generator) -> PlainMotor:
    """Draw a motor that saturates in any way.

    Parameters
    ----------
    rng
        Where chance comes from.
    """
    return replace(motor_of(rng), curve=str(rng.choice(_SATURATING)))


def speed_rad_s(
    motor: PlainMotor,
    phase_deg: Array,
    window_s: float,
    wrong: Wrong,
    rng: np.random.Generator,
    *,
    sampled: bool = False,
) -> tuple[Array, Array]:
    """Return what is measured but for the noise, and the shaft's angle, shape (N,) each.

    Parameters
    ----------
    motor
        The motor.
    phase_deg
        Commanded phases, shape (N,).
    window_s
        Duration of a window.
    wrong
        What is wrong: a cause of the library, or "outside", a belt that beats.
    rng
        Where chance comes from, for what strikes single windows.
    sampled
        Whether the speed is read at the end of each window instead of averaged over it.
    """
    step_s = window_s / FINE
    commanded_deg = _commanded(np.repeat(phase_deg, FINE), step_s, wrong)
    driven = _settled(motor, commanded_deg, step_s, wrong)
    after = _followed(driven, (motor.lag_s + wrong.of("slow_dynamics")) / step_s, motor.brakes_in)
    fine = 0.5 * (after + np.r_[driven[0], after[:-1]])
    angle_rad = np.cumsum(fine) * step_s
    fine = fine * (1.0 + wrong.of("encoder_eccentricity") * np.cos(angle_rad + 1.0))
    windows = fine.reshape(-1, FINE)
    read = windows[:, -1] if sampled else windows.mean(axis=1)
    return _counted(read, wrong, rng), angle_rad[FINE - 1 :: FINE]


def _followed(driven: Array, lag_steps: float, brakes_in: float) -> Array:
    """Speed at the ends of steps of a rotor that follows."""
    kept = np.exp(-1.0 / lag_steps)
    if brakes_in == 1.0:
        after: Array = lfilter([1.0 - kept], [1.0, -kept], driven, zi=[kept * driven[0]])[0]
        return after
    braking, speed, course = np.exp(-1.0 / (brakes_in * lag_steps)), float(driven[0]), []
    for to in driven.tolist():
        slows = abs(to) < abs(speed) or to * speed < 0.0
        speed = to + (braking if slows else kept) * (speed - to)
        course.append(speed)
    return np.array(course)


def _commanded(phase_deg: Array, step_s: float, wrong: Wrong) -> Array:
    """Phases that reach the motor."""
    moved = phase_deg + wrong.of("phase_offset")
    if grid_deg := wrong.of("phase_quantisation"):
        moved = np.round(moved / grid_deg) * grid_deg
    late = round(wrong.of("transport_delay") / step_s)
    return moved[np.maximum(np.arange(moved.size) - late, 0)]


def _settled(motor: PlainMotor, phase_deg: Array, step_s: float, wrong: Wrong) -> Array:
    """Settled speed of what the motor and its load make of the phases."""
    settled = motor.settled_rad_s(phase_deg)
    if later_deg := wrong.of("dead_zone_hysteresis"):
        starts = motor.settled_rad_s(phase_deg - np.sign(phase_deg) * later_deg) != 0.0
        goes, turning = np.zeros(settled.size, dtype=np.bool_), False
        for k, (speed, start) in enumerate(zip(settled, starts, strict=True)):
            turning = bool(speed != 0.0 and (turning or start))
            goes[k] = turning
        settled = settled * goes
    settled = settled * (1.0 + wrong.of("speed_scale") + wrong.of("gain_asymmetry") * (settled > 0))
    t_s = step_s * np.arange(settled.size)
    settled = settled * (1.0 - wrong.of("thermal_drift") * -np.expm1(-2.5 * t_s / t_s[-1]))
    dragged: Array = np.sign(settled) * np.maximum(np.abs(settled) - wrong.of("load_torque"), 0.0)
    return dragged


def _counted(speed_rad_s: Array, wrong: Wrong, rng: np.random.Generator) -> Array:
    """Speed that the counter makes of it."""
    size, limit = np.abs(speed_rad_s), _OFF_COUNT * float(np.max(np.abs(speed_rad_s)))
    lost = wrong.of("missed_counts") * np.maximum(size - limit, 0.0)
    hit = rng.random(size.size) < _GLITCHES
    false = wrong.of("count_glitches") * hit * rng.choice([-1.0, 1.0], size.size)
    belt = wrong.of("outside") * np.sin(0.86 * np.arange(size.size)) * (size > 0.0)
    counted: Array = np.sign(speed_rad_s) * (size - lost) + false + belt
    return counted


def sizes_of(cause: str) -> Array:
    """Return the sizes that a cause may have, rising, shape (K,).

    Parameters
    ----------
    cause
        Its name. A generator's grid is that of a register of some bits.
    """
    if cause == "phase_quantisation":
        return np.asarray(360.0 / 2.0 ** np.arange(14.0, 2.0, -1.0))
    return np.geomspace(1e-5, 100.0, 90)


def size_of(speed: Callable[[Wrong], Array], cause: str, wanted_rad_s: float) -> float | None:
    """Return the first size of a cause that changes a run's speed by so much; None for none.

    Parameters
    ----------
    speed
        The run's speed with something wrong, in rad/s, shape (N,).
    cause
        The cause.
    wanted_rad_s
        Root mean square of what it changes.
    """
    healthy = speed(Wrong())
    return size_for(
        lambda size: float(np.sqrt(np.mean((speed(Wrong(cause, size)) - healthy) ** 2))),
        sizes_of(cause),
        wanted_rad_s,
    )


def size_for(effect_rms: Callable[[float], float], sizes: Array, wanted: float) -> float | None:
    """Return the first size at which an effect's root mean square is as wanted; None for none.

    Parameters
    ----------
    effect_rms
        Root mean square at a size.
    sizes
        Sizes to try, rising, shape (K,).
    wanted
        In the unit of the root mean square.
    """
    return next((float(size) for size in sizes if effect_rms(float(size)) >= wanted), None)
