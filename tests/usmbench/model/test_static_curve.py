"""A static curve goes on beyond its ends as it ends, and beyond ±90° back the way it came."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.model.bernstein import bernstein_basis
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.inverse_map import bezier_abscissa

END_DEG = 60.0
KNOTS_DEG = np.linspace(-END_DEG, END_DEG, 25)


def saturating(phase_deg: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(9.0 * np.tanh(phase_deg / 40.0))


def fitted() -> StaticCurve:
    phase_deg = np.linspace(-END_DEG, END_DEG, 200)
    basis = bernstein_basis(bezier_abscissa(phase_deg, KNOTS_DEG), KNOTS_DEG.size - 1)
    return StaticCurve(KNOTS_DEG, np.array(np.linalg.lstsq(basis, saturating(phase_deg))[0], float))


@pytest.mark.parametrize("beyond_deg", [0.5, 3.0, 8.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_saturating_curve_is_met_better_than_by_its_end(beyond_deg: float, side: float) -> None:
    phase_deg = side * np.array([END_DEG, END_DEG + beyond_deg])
    gained = np.diff(fitted().speed_rad_s(phase_deg))
    assert gained == pytest.approx(np.diff(saturating(phase_deg)), rel=0.2)


@given(st.lists(st.floats(-20.0, 20.0), min_size=2, max_size=9), st.floats(0.0, 40.0))
def test_a_curve_is_continuous_and_levels_off(delta: list[float], beyond_deg: float) -> None:
    curve = StaticCurve(np.linspace(-30.0, 50.0, len(delta)), np.array(delta))
    for end_deg, way in ((-30.0, -1.0), (50.0, 1.0)):
        inside, end, beyond, near = curve.speed_rad_s(
            end_deg + way * np.array([-4.0, 0.0, beyond_deg, 1e-9])
        )
        assert near == pytest.approx(end, abs=1e-7)
        assert abs(beyond - end) <= 4.0 * abs(end - inside) + 1e-9


@pytest.mark.parametrize("end_deg", [60.0, 88.0, 90.0])
@given(beyond_deg=st.floats(0.0, 90.0), side=st.sampled_from([-1.0, 1.0]))
def test_the_wave_travels_no_faster_beyond_a_quarter_turn(
    end_deg: float, beyond_deg: float, side: float
) -> None:
    knots_deg = np.linspace(-end_deg, end_deg, 9)
    curve = StaticCurve(knots_deg, 0.1 * knots_deg + 0.3)
    before, after = curve.speed_rad_s(side * np.array([90.0 - beyond_deg, 90.0 + beyond_deg]))
    assert after == pytest.approx(before, abs=1e-9)


def test_a_curve_that_was_measured_beyond_a_quarter_turn_is_taken_at_its_word() -> None:
    knots_deg = np.linspace(-180.0, 180.0, 9)
    curve = StaticCurve(knots_deg, 0.1 * knots_deg)
    assert curve.speed_rad_s(np.array([170.0])) == pytest.approx(17.0)


@pytest.mark.parametrize("end_deg", [60.0, 88.0, 90.0, 90.5, 97.0, 120.0, 180.0])
@given(st.lists(st.floats(-20.0, 20.0), min_size=2, max_size=9), st.sampled_from([-1.0, 1.0]))
def test_a_curve_does_not_jump_where_it_ends(
    end_deg: float, delta: list[float], side: float
) -> None:
    curve = StaticCurve(np.linspace(-end_deg, end_deg, len(delta)), np.array(delta))
    last, next_ = curve.speed_rad_s(side * (end_deg + np.array([0.0, 1e-9])))
    assert next_ == pytest.approx(last, abs=1e-7)


def test_a_curve_that_ends_just_beyond_the_crest_comes_back_too() -> None:
    knots_deg = np.linspace(-90.5, 90.5, 9)
    curve = StaticCurve(knots_deg, 0.1 * knots_deg)
    assert curve.speed_rad_s(np.array([99.5])) == pytest.approx(8.15)
