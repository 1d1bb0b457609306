"""The rotor's steps against the differential equation, and sticking and slipping."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hil_sim.plant.contact import Grip, traction
from hil_sim.plant.parameters import RotorParameters
from hil_sim.plant.rotor import Piece, Rotor, is_rest

STEP_S = 1e-3
GRIP = Grip(surface_speed_rad_s=10.0, traction_limit_nm=0.8, traction_slip_rad_s=8.0, clamp_nm=0.05)
PARAMETERS = RotorParameters()


def steps(n: int, *, start: int = 0, noise_nm: float = 0.0) -> list[tuple[float, float]]:
    return [((start + k + 1) * STEP_S, noise_nm) for k in range(n)]


def total_angle(rotor: Rotor) -> float:
    return rotor.state.revolutions * 2.0 * math.pi + rotor.state.angle_rad


def end_of(piece: Piece, end_s: float) -> tuple[float, float]:
    """Angle and speed at a piece's end."""
    start_s, revolutions, angle, speed, second, third = piece
    t = end_s - start_s
    return (
        revolutions * 2.0 * math.pi + angle + t * (speed + t * (second + t * third)),
        speed + t * (2.0 * second + 3.0 * t * third),
    )


def test_start_follows_the_differential_equation() -> None:
    friction_nm = GRIP.clamp_nm + PARAMETERS.bearing_friction_nm

    def motion(_t: float, x: np.ndarray) -> list[float]:
        torque_nm = traction(GRIP, float(x[1]))[0] - friction_nm
        return [x[1], torque_nm / PARAMETERS.inertia_kg_m2]

    solution = solve_ivp(motion, (0.0, 0.02), [0.0, 0.0], rtol=1e-9, atol=1e-12)
    rotor = Rotor(PARAMETERS)
    rotor.advance(0.0, steps(20), GRIP)
    assert total_angle(rotor) == pytest.approx(solution.y[0, -1], abs=5e-4)
    assert rotor.state.speed_rad_s == pytest.approx(solution.y[1, -1], abs=5e-3)


def test_path_is_continuous_in_angle_and_speed() -> None:
    rotor = Rotor(PARAMETERS)
    rotor.advance(0.0, steps(1500), GRIP)
    rotor.advance(1.5, steps(100, start=1500), GRIP._replace(surface_speed_rad_s=-5.0))
    rotor.advance(1.6, steps(100, start=1600), GRIP._replace(surface_speed_rad_s=0.0))
    assert is_rest(rotor.path[-1])
    for before, after in zip(rotor.path, rotor.path[1:], strict=False):
        angle, speed = end_of(before, after[0])
        assert angle == pytest.approx(after[1] * 2.0 * math.pi + after[2], abs=1e-9)
        assert speed == pytest.approx(after[3], abs=1e-9)
        assert 0.0 <= after[2] < 2.0 * math.pi


def test_stands_exactly_still_below_breakaway() -> None:
    rotor = Rotor(PARAMETERS)
    weak = GRIP._replace(surface_speed_rad_s=0.3)
    assert rotor.stays(weak, 0.0)
    rotor.advance(0.0, steps(100), weak)
    assert rotor.state == (0.0, 0, 0.0)
    assert len(rotor.path) == 1


def test_breakaway_ratio_makes_it_start_later_than_it_stops() -> None:
    sticky = RotorParameters(breakaway_ratio=1.5)
    between = GRIP._replace(surface_speed_rad_s=0.7)
    standing, turning = Rotor(sticky), Rotor(sticky)
    standing.advance(0.0, steps(100), between)
    turning.advance(0.0, steps(100), GRIP)
    turning.advance(0.1, steps(400, start=100), between)
    assert standing.state.speed_rad_s == 0.0
    assert turning.state.speed_rad_s > 0.0


def test_the_brake_acts_against_either_direction() -> None:
    ends = []
    for sign in (1.0, -1.0):
        rotor = Rotor(PARAMETERS)
        rotor.set_brake(0.2)
        rotor.advance(0.0, steps(200), GRIP._replace(surface_speed_rad_s=sign * 10.0))
        ends.append(rotor.state.speed_rad_s)
    assert ends[0] == pytest.approx(-ends[1], rel=1e-12)
    assert 0.0 < ends[0] < 10.0


def test_a_weight_helps_one_way_only() -> None:
    speeds = []
    for sign in (1.0, -1.0):
        rotor = Rotor(RotorParameters(weight_nm=0.1))
        rotor.advance(0.0, steps(200), GRIP._replace(surface_speed_rad_s=sign * 10.0))
        speeds.append(abs(rotor.state.speed_rad_s))
    assert speeds[0] > speeds[1] + 1.0


def test_a_weight_beyond_all_friction_turns_the_rotor_without_drive() -> None:
    rotor = Rotor(RotorParameters(weight_nm=-0.2))
    rotor.advance(0.0, steps(50), GRIP._replace(surface_speed_rad_s=0.0))
    assert rotor.state.speed_rad_s < 0.0


def test_reversal_inside_a_step_passes_through_zero_once() -> None:
    rotor = Rotor(PARAMETERS)
    rotor.advance(0.0, steps(100), GRIP)
    reverse = GRIP._replace(surface_speed_rad_s=-10.0)
    before = len(rotor.path)
    rotor.advance(0.1, [(0.15, 0.0)], reverse)
    speeds = [piece[3] for piece in rotor.path[before:]]
    assert len(speeds) == 2
    assert speeds[1] == 0.0
    assert rotor.state.speed_rad_s < 0.0
