"""Gaps between measured phases."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.known.gaps import Gaps

TABLE_DEG = np.linspace(-90.0, 90.0, 1801)
LEVELS_DEG = np.arange(-90.0, 91.0, 10.0)


def _off(nodes_deg: list[float], measured_deg: np.ndarray, speed_rad_s: np.ndarray) -> np.ndarray:
    gaps = Gaps.of(measured_deg, TABLE_DEG, [speed_rad_s])
    return gaps.at_nodes_rad_s(np.array(nodes_deg))


def test_a_curve_between_measured_phases_is_as_unsure_as_a_start_there_would_make_it() -> None:
    corner = 0.2 * np.maximum(TABLE_DEG - 14.0, 0.0)
    measured_deg = np.r_[np.arange(-90.0, 0.0, 0.1), np.arange(0.0, 91.0, 10.0)]
    off = _off([-45.03, 3.0, 15.0, 44.0], measured_deg, corner)
    # From 10 to 20 degrees it goes from standstill to 1.2: in the middle, a line across is off by
    # half of that.
    assert off[2] == pytest.approx(0.6, rel=0.01)
    assert (off[0], off[1], off[3]) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert _off([-45.0, 3.0], measured_deg[:1], corner) == pytest.approx([0.0, 0.0])


def test_what_a_curve_does_in_a_gap_the_slopes_beside_it_tell() -> None:
    # The model lets the speed saturate at the level; it may as well do so at 52, less steeply.
    speed = np.interp(TABLE_DEG, [0.0, 50.0, 90.0], [0.0, 10.0, 10.0])
    off = _off([45.0, 50.0, 55.0, 65.0], LEVELS_DEG, speed)
    assert off == pytest.approx([0.5, 0.0, 0.5, 0.0], abs=0.03)


@given(st.floats(31.0, 39.0), st.floats(0.05, 0.5))
def test_a_corner_in_a_gap_is_within_what_the_curve_may_be_off_by(
    corner_deg: float, slope: float
) -> None:
    true = slope * np.minimum(TABLE_DEG, corner_deg)
    # All that a model knows is where the levels lie.
    model = np.interp(TABLE_DEG, LEVELS_DEG, np.interp(LEVELS_DEG, TABLE_DEG, true))
    gaps = Gaps.of(LEVELS_DEG, TABLE_DEG, [model])
    nodes_deg = np.linspace(30.0, 40.0, 6)
    error = np.abs(np.interp(nodes_deg, TABLE_DEG, true - model))
    assert np.all(error <= gaps.at_nodes_rad_s(nodes_deg) + 1e-9)
    # Between two nodes it is off a straight line by no more than a part of that.
    between = gaps.between_nodes_rad_s(nodes_deg)
    inside_deg = np.linspace(30.0, 40.0, 1001)
    bends = np.interp(inside_deg, TABLE_DEG, true) - np.interp(
        inside_deg, nodes_deg, np.interp(nodes_deg, TABLE_DEG, true)
    )
    at = np.minimum(((inside_deg - 30.0) / 2.0).astype(int), 4)
    assert np.all(np.abs(bends) <= between[at] + 0.01 * slope)
    assert between == pytest.approx(0.25 * slope * 2.0, rel=0.05)


def test_between_nodes_of_which_one_is_beyond_the_gap_nothing_is_added() -> None:
    gaps = Gaps.of(LEVELS_DEG, TABLE_DEG, [np.maximum(TABLE_DEG, 0.0)])
    assert gaps.between_nodes_rad_s(np.array([-12.0, -4.0, 4.0, 8.0]))[:2] == pytest.approx(0.0)
    alone = Gaps.of(LEVELS_DEG[:1], TABLE_DEG, [TABLE_DEG])
    assert alone.between_nodes_rad_s(np.array([1.0, 2.0, 3.0])) == pytest.approx([0.0, 0.0])


def test_where_a_dead_zone_ends_between_two_levels_the_model_cannot_know() -> None:
    # The model lets the rotor start at the level itself; it may as well do so at 18, more steeply.
    speed_rad_s = np.interp(TABLE_DEG, [10.0, 20.0, 90.0], [0.0, 1.0, 22.0])
    off = _off([-5.0, 15.0, 20.0, 45.0], LEVELS_DEG, speed_rad_s)
    assert off[1] == pytest.approx(0.25 * 0.3 * 10.0, rel=0.01)
    assert (off[0], off[2], off[3]) == pytest.approx((0.0, 0.0, 0.0), abs=0.05)


@given(st.floats(20.1, 29.9), st.floats(0.05, 0.5))
def test_a_rotor_may_start_anywhere_between_two_levels(start_deg: float, slope: float) -> None:
    true = slope * np.maximum(TABLE_DEG - start_deg, 0.0) * 10.0 / (30.0 - start_deg)
    true = np.minimum(true, slope * np.maximum(TABLE_DEG - 20.0, 0.0))
    model = np.interp(TABLE_DEG, LEVELS_DEG, np.interp(LEVELS_DEG, TABLE_DEG, true))
    nodes_deg = np.linspace(20.0, 30.0, 21)
    error = np.abs(np.interp(nodes_deg, TABLE_DEG, true - model))
    off = Gaps.of(LEVELS_DEG, TABLE_DEG, [model]).at_nodes_rad_s(nodes_deg)
    assert np.all(error <= 2.0 * off + 1e-9)


def test_levels_that_are_one_but_for_rounding_are_one() -> None:
    speed_rad_s = 10.0 * np.sin(np.radians(TABLE_DEG))
    again_deg = np.unique(np.r_[LEVELS_DEG, np.degrees(np.radians(LEVELS_DEG)), LEVELS_DEG + 1e-12])
    assert again_deg.size > LEVELS_DEG.size
    assert _off([5.0, 45.0, 85.0], again_deg, speed_rad_s) == pytest.approx(
        _off([5.0, 45.0, 85.0], LEVELS_DEG, speed_rad_s), rel=1e-6
    )
