"""The size of the noise along the phase: another where the rotor turns than where it stands."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.noise.levels import levels

TURNS_RAD_S, STANDS_RAD_S, ENDS_DEG = 0.03, 0.012, (-9.0, 13.0)


def test_between_phases_of_a_standing_and_a_turning_rotor_it_is_as_loud_as_the_one_that_turns() -> (
    None
):
    """Where in between it comes free, no one knows who drove no phase there."""
    rng = np.random.default_rng(1)
    phase_deg = np.repeat([-80.0, -40.0, -25.0, -4.0, 3.0, 30.0, 70.0], 200)
    stands = (phase_deg > ENDS_DEG[0]) & (phase_deg < ENDS_DEG[1])
    error = np.where(stands, STANDS_RAD_S, TURNS_RAD_S) * rng.standard_normal(phase_deg.size)
    at_deg, found = levels(phase_deg, error, ENDS_DEG)
    outside = np.interp([-25.0, -9.5, -4.1, 3.1, 13.5, 30.0], at_deg, found)
    inside = np.interp([-4.0, 0.0, 3.0], at_deg, found)
    assert outside == pytest.approx(TURNS_RAD_S, rel=0.3)
    assert inside == pytest.approx(STANDS_RAD_S, rel=0.3)


def test_phases_driven_everywhere_part_at_the_end_of_the_dead_zone() -> None:
    rng = np.random.default_rng(1)
    phase_deg = rng.uniform(-80.0, 80.0, 4000)
    stands = (phase_deg > ENDS_DEG[0]) & (phase_deg < ENDS_DEG[1])
    error = np.where(stands, STANDS_RAD_S, TURNS_RAD_S) * rng.standard_normal(phase_deg.size)
    at_deg, found = levels(phase_deg, error, ENDS_DEG)
    assert np.interp([-9.5, 13.5], at_deg, found) == pytest.approx(TURNS_RAD_S, rel=0.3)
    assert np.interp([-8.5, 0.0, 12.5], at_deg, found) == pytest.approx(STANDS_RAD_S, rel=0.3)


def test_a_level_is_of_one_phase_where_phases_lie_far_apart() -> None:
    """Equal shares of the rows would mix the quiet ones of one phase with the loud of the next."""
    rng = np.random.default_rng(3)
    phase_deg = np.repeat(np.arange(20.0, 81.0, 10.0), 130)
    sigma = np.where(phase_deg % 20.0 == 0.0, STANDS_RAD_S, TURNS_RAD_S)
    at_deg, found = levels(phase_deg, sigma * rng.standard_normal(phase_deg.size), ENDS_DEG)
    assert np.interp([20.0, 40.0, 60.0], at_deg, found) == pytest.approx(STANDS_RAD_S, rel=0.4)
    assert np.interp([30.0, 35.0, 50.0, 70.0], at_deg, found) == pytest.approx(TURNS_RAD_S, rel=0.3)


def test_a_few_rows_of_a_standing_rotor_tell_no_level() -> None:
    rng = np.random.default_rng(2)
    phase_deg = np.r_[rng.uniform(20.0, 80.0, 500), np.zeros(5)]
    error = TURNS_RAD_S * rng.standard_normal(phase_deg.size) * (phase_deg > 0.0)
    at_deg, found = levels(phase_deg, error, ENDS_DEG)
    assert np.interp(0.0, at_deg, found) == pytest.approx(TURNS_RAD_S, rel=0.2)


@given(
    st.lists(st.floats(-90.0, 90.0), min_size=1, max_size=200),
    st.floats(0.0, 40.0),
    st.floats(0.0, 40.0),
)
def test_any_phases_have_levels_that_can_be_told_between_them(
    phases_deg: list[float], low: float, high: float
) -> None:
    phase_deg = np.array(phases_deg)
    at_deg, found = levels(phase_deg, 0.01 * np.ones(phase_deg.size), (-low, high))
    assert np.all(np.diff(at_deg) >= 0.0)
    assert found == pytest.approx(0.01, rel=1.0)
    assert np.all(np.isfinite(np.interp(phase_deg, at_deg, found)))
