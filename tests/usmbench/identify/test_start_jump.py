"""A motor that starts with a jump is found to, and one that only bends is not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.identify.curve_rows import CurveRows
from usmbench.identify.dynamics import NONE
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.knots import dead_zone_deg
from usmbench.identify.start_jump import (
    StartJump,
    jump_edges_deg,
    jump_widths,
    rises,
    start_jumps,
)
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Array = NDArray[np.float64]
SPAN_DEG, WINDOW_S = (-90.0, 90.0), 0.01


def settled_rad_s(
    phase_deg: Array, edges_deg: tuple[float, float], jumps_rad_s: tuple[float, float]
) -> Array:
    """Return speeds that begin with a jump on each side, and saturate."""
    (low_deg, high_deg), (down, up) = edges_deg, jumps_rad_s
    forward = up - 9.0 * np.expm1(-(phase_deg - high_deg) / 40.0)
    backward = -down + 9.0 * np.expm1((phase_deg - low_deg) / 40.0)
    return np.where(phase_deg > high_deg, forward, np.where(phase_deg < low_deg, backward, 0.0))


def rows(phase_deg: Array, speed_rad_s: Array) -> CurveRows:
    fold, weight = np.zeros(phase_deg.size, dtype=np.int64), np.ones(phase_deg.size)
    return CurveRows((phase_deg,), (speed_rad_s,), (fold,), NONE, (weight,))


def measured(
    seed: int, edges_deg: tuple[float, float], jumps_rad_s: tuple[float, float]
) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    phase_deg = np.r_[SPAN_DEG, rng.uniform(*SPAN_DEG, 3000)]
    speed_rad_s = settled_rad_s(phase_deg, edges_deg, jumps_rad_s)
    return phase_deg, speed_rad_s + 0.03 * rng.standard_normal(phase_deg.size)


@given(
    seed=st.integers(0, 999),
    low_deg=st.floats(-20.0, -4.0),
    high_deg=st.floats(4.0, 20.0),
    jumps_rad_s=st.tuples(st.floats(0.4, 2.0), st.floats(0.4, 2.0)),
)
@settings(max_examples=20, deadline=None)
def test_a_jump_on_each_side_is_found_where_it_is(
    seed: int, low_deg: float, high_deg: float, jumps_rad_s: tuple[float, float]
) -> None:
    edges_deg = low_deg, high_deg
    found = start_jumps(rows(*measured(seed, edges_deg, jumps_rad_s)), SPAN_DEG)
    assert len(found) == 2
    for jump, edge_deg in zip(found, edges_deg, strict=True):
        assert jump.phase_deg == pytest.approx(
            edge_deg, abs=jump.reach_deg + 0.1
        )  # three phases apart
        assert jump.reach_deg < 0.5


@given(seed=st.integers(0, 999), low_deg=st.floats(-20.0, -4.0), high_deg=st.floats(4.0, 20.0))
@settings(max_examples=20, deadline=None)
def test_a_sharp_bend_is_no_jump(seed: int, low_deg: float, high_deg: float) -> None:
    assert start_jumps(rows(*measured(seed, (low_deg, high_deg), (0.0, 0.0))), SPAN_DEG) == ()


def test_one_side_may_jump_alone() -> None:
    phase_deg, speed_rad_s = measured(3, (-9.0, 7.0), (0.0, 1.0))
    (jump,) = start_jumps(rows(phase_deg, speed_rad_s), SPAN_DEG)
    assert jump.phase_deg == pytest.approx(7.0, abs=0.1)
    bent = StaticCurve(np.linspace(*SPAN_DEG, 5), np.array([-9.0, 0.0, 0.0, 0.0, 9.0]))
    assert jump_edges_deg([jump], bent) == (dead_zone_deg(bent)[0], jump.phase_deg)


def test_a_dead_zone_that_lies_on_one_side_of_0_keeps_its_other_edge() -> None:
    bent = StaticCurve(np.linspace(-60.0, 120.0, 5), np.array([-9.0, 0.0, 0.0, 0.0, 9.0]))
    low_deg, high_deg = dead_zone_deg(bent)
    assert low_deg is not None
    assert high_deg is not None
    jump = StartJump(high_deg + 0.3, 0.1)
    assert jump_edges_deg([jump], bent) == (low_deg, jump.phase_deg)
    assert jump_edges_deg([StartJump(low_deg, 0.1), jump], bent) == (low_deg, jump.phase_deg)


def test_what_never_stands_does_not_start() -> None:
    phase_deg = np.random.default_rng(1).uniform(*SPAN_DEG, 500)
    assert start_jumps(rows(phase_deg, 5.0 + 0.01 * phase_deg), SPAN_DEG) == ()


def test_a_curve_that_falls_back_is_free_between_phases() -> None:
    knots_deg = np.linspace(-90.0, 90.0, 5)
    assert rises(StaticCurve(knots_deg, np.linspace(-9.0, 9.0, 5)), (-5.0, 5.0))
    hill = StaticCurve(knots_deg, np.array([-9.0, -4.5, 0.0, 20.0, 5.0]))
    assert rises(hill, (-50.0, 30.0))
    assert not rises(hill, (-50.0, 75.0))


def test_knots_gather_as_closely_as_the_place_is_known() -> None:
    assert jump_widths([StartJump(6.0, 0.0)], SPAN_DEG)[0] * 180.0 < 0.1
    close, *wider = jump_widths([StartJump(-6.0, 0.27), StartJump(6.0, 0.1)], SPAN_DEG)
    assert close * 180.0 == pytest.approx(0.27)
    assert all(width > close for width in wider)


@pytest.mark.parametrize("seed", range(3))
def test_a_curve_jumps_where_its_motor_does(seed: int) -> None:
    rng = np.random.default_rng([seed, 7])
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
