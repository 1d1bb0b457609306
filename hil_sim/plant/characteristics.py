"""What a bench would find out about a simulated motor: speeds, dead zone, lag, warm-up.

Everything here is measured by running the plant and reading its disc, nothing is computed from
the parameters, so that it can be held against published figures.
"""

from typing import NamedTuple

from hil_sim.plant.parameters import PlantParameters
from hil_sim.plant.rig import OperatingPoint, Rig

FULL_SPEED_RAD_S = 10.25
"""Published gain k_m, the full speed at 41 kHz without load."""

LAG_S = 0.0035
"""Published time constant."""

# Slower than one count in the averaging time counts as standing still, noise's first kicks too.
_MOVES_RAD_S = 0.05


PUBLISHED_POINTS = tuple(
    OperatingPoint(frequency_hz, torque_nm)
    for frequency_hz in (41_000.0, 41_500.0, 42_000.0)
    for torque_nm in (0.0, 0.1, 0.2)
)
"""The nine operating points of the paper's Section V."""


class WarmUp(NamedTuple):
    """Speed and stator temperature before and after a time of full drive.

    Parameters
    ----------
    cold_rad_s, warm_rad_s
        Speeds.
    cold_c, warm_c
        Temperatures.
    """

    cold_rad_s: float
    warm_rad_s: float
    cold_c: float
    warm_c: float

    @property
    def speed_change(self) -> float:
        """Relative change of the speed."""
        return self.warm_rad_s / self.cold_rad_s - 1.0


def static_curve(
    parameters: PlantParameters, point: OperatingPoint, phases_deg: list[float]
) -> list[float]:
    """Return the settled speed at each phase shift, one after the other on the cold motor.

    Parameters
    ----------
    parameters
        The motor.
    point
        Frequency and load.
    phases_deg
        Phase shifts, in the order they are driven.

    Returns
    -------
    list of float
        Speeds in rad/s.
    """
    rig = Rig(parameters, point)
    speeds = []
    for phase_deg in phases_deg:
        rig.drive(phase_deg)
        speeds.append(rig.speed())
    return speeds


def dead_zone_deg(parameters: PlantParameters, point: OperatingPoint) -> tuple[float, float]:
    """Return the dead zone's edges, found by bisection from rest.

    Parameters
    ----------
    parameters
        The motor.
    point
        Frequency and load.

    Returns
    -------
    tuple of float
        Lower and upper edge in degrees, to 0.1; ∓90 where it does not move at all.
    """
    low, high = (_edge_deg(parameters, point, sign) for sign in (-1.0, 1.0))
    return low, high


def _edge_deg(parameters: PlantParameters, point: OperatingPoint, sign: float) -> float:
    """Edge of the dead zone on one side."""
    still_deg, moving_deg = 0.0, 90.0
    while moving_deg - still_deg > 0.1:
        middle_deg = 0.5 * (still_deg + moving_deg)
        (speed,) = static_curve(parameters, point, [sign * middle_deg])
        if abs(speed) > _MOVES_RAD_S:
            moving_deg = middle_deg
        else:
            still_deg = middle_deg
    return sign * moving_deg


def lag_s(
    parameters: PlantParameters,
    point: OperatingPoint,
    from_deg: float,
    to_deg: float,
    *,
    repeats: int = 10,
) -> float:
    """Return the lag of the speed behind steps of the phase shift.

    Parameters
    ----------
    parameters
        The motor.
    point
        Frequency and load.
    from_deg, to_deg
        Phase shift before and after the step.
    repeats
        Steps averaged.

    Returns
    -------
    float
        Area between the step and the speed, over the step's height; τ for a first-order lag.
    """
    rig = Rig(parameters, point)
    missing_rad = rise_rad_s = 0.0
    for _ in range(repeats):
        rig.drive(from_deg)
        before_rad_s = rig.speed()
        rig.drive(to_deg)
        turned_rad = rig.turn(0.05)
        after_rad_s = rig.speed(0.0)
        missing_rad += 0.05 * after_rad_s - turned_rad
        rise_rad_s += after_rad_s - before_rad_s
    return missing_rad / rise_rad_s


def warm_up(parameters: PlantParameters, point: OperatingPoint, duration_s: float) -> WarmUp:
    """Return how speed and temperature change under full drive.

    Parameters
    ----------
    parameters
        The motor.
    point
        Frequency and load.
    duration_s
        Time of full drive.

    Returns
    -------
    WarmUp
        Speeds averaged over half a second at either end.
    """
    rig = Rig(parameters, point)
    rig.drive(90.0)
    cold = rig.speed(average_s=0.5), rig.temperature_c
    rig.turn(duration_s)
    warm = rig.speed(average_s=0.5), rig.temperature_c
    return WarmUp(cold[0], warm[0], cold[1], warm[1])
