"""The default motor beside the published figures, measured by running it."""

from dataclasses import replace

import pytest

from hil_sim.plant.characteristics import (
    FULL_SPEED_RAD_S,
    LAG_S,
    PUBLISHED_POINTS,
    dead_zone_deg,
    lag_s,
    static_curve,
    warm_up,
)
from hil_sim.plant.parameters import PlantParameters
from hil_sim.plant.rig import OperatingPoint

MOTOR = PlantParameters()
NO_LOAD = OperatingPoint()
# Half-widths of the dead zone that Section V and its knots leave room for.
HALF_WIDTHS_DEG = {
    (41_000.0, 0.0): (3.0, 6.0),
    (41_000.0, 0.1): (8.0, 13.0),
    (41_000.0, 0.2): (14.0, 20.0),
    (41_500.0, 0.0): (48.0, 60.0),
    (41_500.0, 0.1): (50.0, 65.0),
    (41_500.0, 0.2): (58.0, 70.0),
    (42_000.0, 0.0): (55.0, 65.0),
    (42_000.0, 0.1): (60.0, 68.0),
    (42_000.0, 0.2): (65.0, 75.0),
}


@pytest.mark.parametrize("phase_deg", [90.0, -90.0])
def test_full_speed(phase_deg: float) -> None:
    (speed_rad_s,) = static_curve(MOTOR, NO_LOAD, [phase_deg])
    assert speed_rad_s * (1 if phase_deg > 0 else -1) == pytest.approx(FULL_SPEED_RAD_S, rel=0.01)


@pytest.mark.parametrize(("from_deg", "to_deg"), [(0.0, 90.0), (20.0, 60.0)])
def test_lag(from_deg: float, to_deg: float) -> None:
    lag = lag_s(MOTOR, NO_LOAD, from_deg, to_deg, repeats=20)
    assert lag == pytest.approx(LAG_S, rel=0.15)


@pytest.mark.parametrize("point", PUBLISHED_POINTS)
def test_dead_zone_holds_zero_and_has_its_edges_where_published(point: OperatingPoint) -> None:
    narrow_deg, wide_deg = HALF_WIDTHS_DEG[point.frequency_hz, point.torque_nm]
    low_deg, high_deg = dead_zone_deg(MOTOR, point)
    assert -wide_deg <= low_deg <= -narrow_deg
    assert narrow_deg <= high_deg <= wide_deg


@pytest.mark.parametrize("point", PUBLISHED_POINTS)
def test_speed_rises_with_the_phase_and_saturates(point: OperatingPoint) -> None:
    speeds = static_curve(MOTOR, point, [0.0, 72.0, 78.0, 84.0, 90.0])
    assert speeds[0] == 0.0
    assert speeds == sorted(speeds)
    assert speeds[-1] > 1.0
    assert speeds[4] - speeds[3] < 0.6 * (speeds[2] - speeds[1])


def test_matched_modes_and_no_noise_make_the_motor_odd() -> None:
    matched = replace(
        MOTOR,
        stator=replace(MOTOR.stator, resonance_mismatch_hz=0.0, gain_mismatch=0.0),
        rotor=replace(MOTOR.rotor, noise_nm=0.0),
    )
    phases_deg = [10.0, 30.0, 50.0, 70.0, 90.0]
    up = static_curve(matched, NO_LOAD, phases_deg)
    down = static_curve(matched, NO_LOAD, [-phase_deg for phase_deg in phases_deg])
    assert up == pytest.approx([-speed for speed in down], abs=0.04)  # a count is 0.031 rad/s


def test_mismatch_of_the_modes_makes_one_direction_a_per_cent_or_so_faster() -> None:
    up, down = (static_curve(MOTOR, NO_LOAD, [sign * 45.0])[0] for sign in (1.0, -1.0))
    assert 0.005 < abs(up / -down - 1.0) < 0.03


def test_warm_up_slows_the_motor_by_a_per_cent_or_two() -> None:
    warming = warm_up(MOTOR, NO_LOAD, 300.0)
    assert 10.0 < warming.warm_c - warming.cold_c < 30.0
    assert -0.025 < warming.speed_change < -0.008
