"""Knots gather at the jumps of a motor that starts with one."""

import numpy as np
import pytest

from jumping_motor import settled_rad_s
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.jumping_curve import jump_edges_deg, jump_widths, rises
from usmbench.identify.knots import dead_zone_deg
from usmbench.identify.start_jump import StartJump
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

SPAN_DEG, WINDOW_S = (-90.0, 90.0), 0.01


def test_the_side_that_bends_keeps_its_edge() -> None:
    jump = StartJump(7.0, 0.1, 1.0)
    bent = StaticCurve(np.linspace(*SPAN_DEG, 5), np.array([-9.0, 0.0, 0.0, 0.0, 9.0]))
    assert jump_edges_deg([jump], bent) == (dead_zone_deg(bent)[0], jump.phase_deg)


def test_a_dead_zone_that_lies_on_one_side_of_0_keeps_its_other_edge() -> None:
    bent = StaticCurve(np.linspace(-60.0, 120.0, 5), np.array([-9.0, 0.0, 0.0, 0.0, 9.0]))
    low_deg, high_deg = dead_zone_deg(bent)
    assert low_deg is not None
    assert high_deg is not None
    jump = StartJump(high_deg + 0.3, 0.1, 1.0)
    assert jump_edges_deg([jump], bent) == (low_deg, jump.phase_deg)
    assert jump_edges_deg([StartJump(low_deg, 0.1, 1.0), jump], bent) == (low_deg, jump.phase_deg)


def test_a_curve_that_falls_back_is_free_between_phases() -> None:
    knots_deg = np.linspace(-90.0, 90.0, 5)
    assert rises(StaticCurve(knots_deg, np.linspace(-9.0, 9.0, 5)), (-5.0, 5.0))
    hill = StaticCurve(knots_deg, np.array([-9.0, -4.5, 0.0, 20.0, 5.0]))
    assert rises(hill, (-50.0, 30.0))
    assert not rises(hill, (-50.0, 75.0))


def test_knots_gather_as_closely_as_the_place_is_known() -> None:
    assert jump_widths([StartJump(6.0, 0.0, 1.0)], SPAN_DEG)[0] * 180.0 < 0.1
    close, *wider = jump_widths([StartJump(-6.0, 0.27, 1.0), StartJump(6.0, 0.1, 1.0)], SPAN_DEG)
    assert close * 180.0 == pytest.approx(0.27)
    assert all(width > close for width in wider)


def test_a_curve_jumps_where_its_motor_does() -> None:
    rng = np.random.default_rng([0, 7])
    edges_deg = -rng.uniform(5.0, 15.0), rng.uniform(5.0, 15.0)
    jumps_rad_s = rng.uniform(0.5, 1.5), rng.uniform(0.5, 1.5)
    n = 3000
    triangle_deg = 90.0 * (1.0 - 4.0 * np.abs(np.arange(n) / 500.0 % 1.0 - 0.5))
    telegraph_deg = np.repeat(rng.uniform(-20.0, 20.0, n // 5), 5)
    records = []
    for name, phase_deg in (("triangle", np.round(triangle_deg, 2)), ("telegraph", telegraph_deg)):
        speed_rad_s = settled_rad_s(phase_deg, edges_deg, jumps_rad_s)
        speed_rad_s = free_run(first_order(0.0035, 0.0015, WINDOW_S), speed_rad_s)
        noisy = speed_rad_s + 0.02 * rng.standard_normal(n)
        t_s = WINDOW_S * np.arange(1.0, n + 1.0)
        records.append(Record(name, t_s, phase_deg, noisy, np.full(n, WINDOW_S)))
    found = identify_fast(records, FastOptions())
    (point,) = found.model.points
    assert point.dead_zone_deg == pytest.approx(edges_deg, abs=0.5)
    grid_deg = np.linspace(*SPAN_DEG, 1801)
    off_rad_s = point.curve.speed_rad_s(grid_deg) - settled_rad_s(grid_deg, edges_deg, jumps_rad_s)
    away = np.min(np.abs(grid_deg[:, None] - edges_deg), axis=1) > 0.5
    assert np.sqrt(np.mean(off_rad_s[away] ** 2)) < 0.02
    assert np.mean(np.abs(off_rad_s[~away])) < 0.25 * min(jumps_rad_s)
