"""Curves between the few phases that were driven."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from benchmarks.identification_few_phases import PHASES_DEG
from usmbench.identify.between_levels import Levels
from usmbench.model.hammerstein import StaticCurve

LEVELS_DEG = PHASES_DEG[0]
KNOTS_DEG = np.linspace(-80.0, 80.0, 13)


@given(
    st.floats(-0.5, 0.5).filter(lambda slope: abs(slope) > 1e-3),
    st.floats(-5.0, 5.0),
    st.lists(st.integers(-79, 79), min_size=1, max_size=8, unique=True),
)
def test_a_straight_curve_along_which_the_rotor_turns_is_not_pulled(
    slope: float, at_0: float, inner_deg: list[int]
) -> None:
    phase_deg = np.array([-80.0, *sorted(inner_deg), 80.0])
    size_rad_s = np.abs(slope * phase_deg + at_0)
    assume(np.min(size_rad_s) > 0.01 * np.max(size_rad_s))
    levels = Levels(phase_deg, slope * phase_deg + at_0)
    straight = StaticCurve(KNOTS_DEG, slope * KNOTS_DEG + at_0)
    assert levels.holds(straight)
    assert levels.pull(KNOTS_DEG) @ straight.delta == pytest.approx(0.0, abs=1e-9)


def _fitted(
    levels: Levels, speed_rad_s: NDArray[np.float64], knots_deg: NDArray[np.float64] = KNOTS_DEG
) -> StaticCurve:
    """A curve that meets the speeds at the levels, and is otherwise only pulled."""
    pull, ones = 1e-3 * levels.pull(knots_deg), np.eye(knots_deg.size)
    at = np.array([StaticCurve(knots_deg, one).speed_rad_s(levels.phase_deg) for one in ones])
    rows, wanted = np.vstack([at.T, pull]), np.r_[speed_rad_s, np.zeros(len(pull))]
    return StaticCurve(knots_deg, np.linalg.lstsq(rows, wanted, rcond=None)[0])


@given(st.floats(-0.02, 0.02), st.floats(0.9, 1.1))
def test_where_the_levels_are_is_left_to_the_samples(offset: float, gain: float) -> None:
    speed_rad_s = 10.0 * np.tanh(LEVELS_DEG / 40.0)
    levels = Levels(LEVELS_DEG, speed_rad_s)
    curve = _fitted(levels, gain * speed_rad_s + offset)
    assert curve.speed_rad_s(LEVELS_DEG) == pytest.approx(gain * speed_rad_s + offset, abs=1e-3)
    between_deg = np.linspace(-80.0, 80.0, 161)
    plain = _fitted(levels, speed_rad_s).speed_rad_s(between_deg)
    assert curve.speed_rad_s(between_deg) == pytest.approx(gain * plain + offset, abs=1e-3)


def test_between_levels_at_which_the_motor_stands_it_is_pulled_to_stand() -> None:
    speed_rad_s = np.array([-9.0, -5.0, 0.0, 0.0, 0.0, 5.0, 9.0])
    curve = _fitted(Levels(LEVELS_DEG, speed_rad_s), speed_rad_s)
    assert np.max(np.abs(curve.speed_rad_s(np.linspace(-20.0, 20.0, 81)))) < 0.1 * 9.0


def test_where_the_motor_stands_it_is_pulled_to_be_level() -> None:
    speed_rad_s = np.array([-9.0, -5.0, -2.0, 0.0, 2.0, 5.0, 9.0])
    knots_deg = np.linspace(-80.0, 80.0, 61)  # degrees that follow a bend
    curve = _fitted(Levels(LEVELS_DEG, speed_rad_s), speed_rad_s, knots_deg)
    low_rad_s, high_rad_s = curve.speed_rad_s(np.array([-2.0, 2.0]))
    assert abs(high_rad_s - low_rad_s) / 4.0 < 0.04


@pytest.mark.parametrize(
    ("level", "speed_rad_s", "holds"), [(4, 1.7, False), (4, 1.95, True), (5, 3.7, True)]
)
def test_beside_a_level_at_which_it_stands_a_motor_leaves_the_speeds_by_less(
    level: int, speed_rad_s: float, holds: bool
) -> None:
    speeds_rad_s = 0.1 * LEVELS_DEG
    speeds_rad_s[level] = speed_rad_s
    straight = StaticCurve(KNOTS_DEG, 0.1 * KNOTS_DEG)
    assert Levels(LEVELS_DEG, speeds_rad_s).holds(straight) == holds


def test_phases_that_are_one_but_for_rounding_are_one_level() -> None:
    curve = StaticCurve(KNOTS_DEG, 10.0 * np.tanh(KNOTS_DEG / 40.0))
    again_deg = np.degrees(np.radians(LEVELS_DEG + 1e-12))
    assert np.unique(np.r_[LEVELS_DEG, again_deg]).size > LEVELS_DEG.size
    levels = Levels.of(np.r_[LEVELS_DEG, again_deg, LEVELS_DEG], curve)
    assert levels.phase_deg == pytest.approx(LEVELS_DEG)
    assert levels.pull(KNOTS_DEG) == pytest.approx(
        Levels.of(LEVELS_DEG, curve).pull(KNOTS_DEG), abs=1e-9
    )
