"""The size of the noise along the phase: another where the rotor turns than where it stands."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.noise.levels import levels

TURNS_RAD_S, STANDS_RAD_S, ENDS_DEG = 0.03, 0.012, (-9.0, 13.0)


def test_the_level_passes_from_one_to_the_other_at_the_end_of_the_dead_zone() -> None:
    """Though no phase was driven near it, as in a telegraph of few levels."""
    rng = np.random.default_rng(1)
    phase_deg = np.repeat([-80.0, -40.0, -25.0, -4.0, 3.0, 30.0, 70.0], 200)
    stands = (phase_deg > ENDS_DEG[0]) & (phase_deg < ENDS_DEG[1])
    error = np.where(stands, STANDS_RAD_S, TURNS_RAD_S) * rng.standard_normal(phase_deg.size)
    at_deg, found = levels(phase_deg, error, ENDS_DEG)
    outside = np.interp([-20.0, -9.5, 13.5, 20.0], at_deg, found)
    inside = np.interp([-8.5, 0.0, 12.5], at_deg, found)
    assert outside == pytest.approx(TURNS_RAD_S, rel=0.3)
    assert inside == pytest.approx(STANDS_RAD_S, rel=0.3)


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
