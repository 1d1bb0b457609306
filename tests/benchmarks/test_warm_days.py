"""Motors that are warm when a run begins: how they are drawn, and what is made of them."""

import numpy as np
import pytest

from benchmarks.plain_motor import FINE, PlainMotor
from benchmarks.warm_days import Day, Warming, report

MOTOR = PlainMotor((8.0, 12.0), 25.0, 10.0, 0.003)
WARMING = Warming(0.02, 0.06, 30.0)


def test_a_warm_motor_has_lost_speed_and_its_dead_zone_is_wider() -> None:
    cold, warm = (WARMING.of(MOTOR, begins, 6000) for begins in (0.0, 1.0))
    np.testing.assert_allclose(warm.top_rad_s, 0.98 * MOTOR.top_rad_s)
    assert np.asarray(cold.top_rad_s)[0] == MOTOR.top_rad_s
    after = round(WARMING.constant_s / 0.01) * FINE
    lost = 1.0 - np.asarray(cold.top_rad_s)[after] / MOTOR.top_rad_s
    assert lost == pytest.approx(0.02 * (1.0 - np.exp(-1.0)))
    for edge_deg, wide_deg in zip(MOTOR.edges_deg, warm.edges_deg, strict=True):
        np.testing.assert_allclose(wide_deg, 1.06 * edge_deg)


def test_what_is_not_right_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    days = [
        Day("warm, healthy", "", WARMING, 0.7, "explained", (("thermal_drift", "load_torque"),)),
        Day("cold, wrong", "load_torque", WARMING, 0.0, "explained", (("load_torque",),)),
    ]
    assert [day.right for day in days] == [False, True]
    assert [day.misled for day in days] == [True, False]
    report(days)
    said = capsys.readouterr().out
    assert "warm, healthy     0.0" in said
    assert "began at 0.70, loses 2.0 %, widens 6.0 %, 30 s" in said
    assert "cold, wrong     100.0" in said
