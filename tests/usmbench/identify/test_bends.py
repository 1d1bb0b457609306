"""Sharp bends are found where a smooth curve of even knots would miss them."""

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.identify.bends import bends_of_rows, joined
from usmbench.identify.curve_rows import CurveRows
from usmbench.identify.dynamics import NONE
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.runs.record import Record

SPAN_DEG, NOISE_RAD_S = (-90.0, 90.0), 0.02


def sharp_rad_s(
    phase_deg: NDArray[np.float64], edge_deg: float, knee_deg: float
) -> NDArray[np.float64]:
    """Return speeds that begin and stop to rise at once."""
    size = np.clip((np.abs(phase_deg) - edge_deg) / (knee_deg - edge_deg), 0.0, 1.0)
    return np.asarray(10.0 * np.sign(phase_deg) * size)


@pytest.mark.parametrize("seed", range(5))
def test_a_polygon_finds_where_the_speed_begins_and_stops_to_rise(seed: int) -> None:
    rng = np.random.default_rng(seed)
    edge_deg, knee_deg = rng.uniform(8.0, 25.0), rng.uniform(45.0, 75.0)
    phase_deg = np.r_[SPAN_DEG, rng.uniform(*SPAN_DEG, 1000)]
    speed_rad_s = sharp_rad_s(phase_deg, edge_deg, knee_deg)
    speed_rad_s = speed_rad_s + NOISE_RAD_S * rng.standard_normal(phase_deg.size)
    fold, weight = np.zeros(phase_deg.size, dtype=np.int64), np.ones(phase_deg.size)
    rows = CurveRows((phase_deg,), (speed_rad_s,), (fold,), NONE, (weight,))
    edges_deg, all_deg = bends_of_rows(rows, SPAN_DEG)
    assert edges_deg == pytest.approx((-edge_deg, edge_deg), abs=1.0)
    assert sorted(all_deg[2:]) == pytest.approx([-knee_deg, knee_deg], abs=4.0)


def test_two_phases_do_not_bend() -> None:
    phase_deg = np.array([-90.0, 90.0] * 5)
    fold, weight = np.zeros(10, dtype=np.int64), np.ones(10)
    rows = CurveRows((phase_deg,), (0.1 * phase_deg,), (fold,), NONE, (weight,))
    assert bends_of_rows(rows, SPAN_DEG) == ()


def test_bends_at_the_same_places_are_joined() -> None:
    some, others = ((-10.0, 10.0),), ((-10.5, 10.5), (-10.0, 10.0, 50.0), (-20.0, 10.0))
    assert joined(some, others, SPAN_DEG) == ((-10.0, 10.0), *others[1:])


@pytest.mark.parametrize("seed", range(3))
def test_a_curve_follows_a_sharp_edge_in_a_triangle(seed: int) -> None:
    rng = np.random.default_rng(seed)
    edge_deg, reach_deg = rng.uniform(8.0, 25.0), rng.uniform(25.0, 60.0)
    along = np.arange(2000) / 250.0
    phase_deg = np.round(90.0 * (1.0 - 4.0 * np.abs(along % 1.0 - 0.5)), 1)
    beyond_deg = np.maximum(np.abs(phase_deg) - edge_deg, 0.0)
    speed_rad_s = -10.0 * np.sign(phase_deg) * np.expm1(-beyond_deg / reach_deg)
    noisy = speed_rad_s + NOISE_RAD_S * rng.standard_normal(2000)
    record = Record("run", 0.01 * np.arange(1.0, 2001.0), phase_deg, noisy, np.full(2000, 0.01))
    (point,) = identify_fast([record], FastOptions()).model.points
    off_rad_s = point.curve.speed_rad_s(phase_deg) - speed_rad_s
    assert np.sqrt(np.mean(off_rad_s**2)) < 0.6 * NOISE_RAD_S
