"""Healthy motors on other days: a few of them, and what the benchmark makes of them."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.healthy_days import Healthy, on_a_day, report
from benchmarks.plain_motor import CURVES, PlainMotor, Wrong, speed_rad_s

MOTOR = PlainMotor((8.0, 12.0), 25.0, 10.0, 0.003, "steep")


def test_a_motor_that_brakes_faster_does_so_and_runs_up_as_before() -> None:
    phase_deg = np.repeat([0.0, 60.0, 0.0], 10)
    plain, braking = (
        speed_rad_s(motor, phase_deg, 0.01, Wrong(), np.random.default_rng(1))[0]
        for motor in (MOTOR, replace(MOTOR, brakes_in=0.5))
    )
    np.testing.assert_allclose(braking[:20], plain[:20])
    assert braking[20] == pytest.approx(plain[20] * 0.5, rel=0.05)


def test_both_ends_of_a_dead_zone_move_by_the_same_share() -> None:
    rng = np.random.default_rng(2)
    days = [on_a_day(MOTOR, 0.01, rng) for _ in range(400)]
    widths = np.array([day.edges_deg for day in days]) / MOTOR.edges_deg
    assert widths[:, 0] == pytest.approx(widths[:, 1])
    assert np.std(widths[:, 0]) == pytest.approx(0.01, rel=0.15)
    assert on_a_day(MOTOR, 0.0, rng) == MOTOR


@pytest.mark.parametrize("curve", ["steep", "gentle"])
def test_a_motor_starts_steeply_or_gently_and_alike_both_ways(curve: str) -> None:
    beyond = np.array([0.01, 0.1, 1.0, 10.0])
    speeds = CURVES[curve](beyond)
    assert np.all((speeds[:2] > beyond[:2]) == (curve == "steep"))
    assert speeds[-1] == pytest.approx(1.0)
    np.testing.assert_array_equal(CURVES[curve](-beyond), -speeds)


def test_an_alarm_is_listed_with_its_names(capsys: pytest.CaptureFixture[str]) -> None:
    quiet = Healthy(0.003, "ramp", "no_discrepancy", ())
    report([quiet, Healthy(0.01, "steep", "explained", ("load_torque",))])
    said = capsys.readouterr().out
    assert "all               50.0" in said
    assert "steep, 1 %: explained load_torque" in said
