"""How far the shaft has come since its last edge."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.instruments.edge_timing import EDGES_KEPT, fraction_passed


@given(st.integers(2, EDGES_KEPT), st.floats(3.0, 5000.0), st.floats(0.0, 0.99))
@settings(deadline=None)
def test_constant_speed_is_interpolated_exactly(n: int, period: float, fraction: float) -> None:
    edges = np.linspace(0.0, period * (n - 1), n)
    found = fraction_passed(edges, float(edges[-1]) + fraction * period)
    assert found == pytest.approx(fraction, abs=1e-6)


@pytest.mark.parametrize("acceleration", [-0.02, 0.02])
def test_a_steady_acceleration_is_followed(acceleration: float) -> None:
    crossed = np.arange(-7.0, 1.0)
    period = 50.0
    edges = period * (crossed + acceleration * crossed**2)
    found = fraction_passed(edges, period * (0.5 + acceleration * 0.25))
    assert found == pytest.approx(0.5, abs=1e-9)


@given(
    st.lists(st.integers(1, 10**6), max_size=EDGES_KEPT - 1),
    st.integers(0, 10**9),
)
@settings(deadline=None)
def test_the_shaft_stays_between_the_boundaries(intervals: list[int], later: int) -> None:
    edges = np.cumsum([0, *intervals]) - 0.5
    assert 0.0 <= fraction_passed(edges, float(edges[-1]) + later + 0.5) <= 1.0


def test_an_overdue_edge_is_waited_for_at_its_boundary() -> None:
    assert fraction_passed(np.array([0.0, 100.0]), 350.0) == 1.0


def test_one_edge_tells_no_speed() -> None:
    assert fraction_passed(np.array([12.5]), 4000.0) == 0.0


def test_motion_before_a_pause_does_not_count() -> None:
    edges = np.array([*range(0, 1000, 100), 50_000, 50_010, 50_020], dtype=float)
    assert fraction_passed(edges, 50_025.0) == pytest.approx(0.5, abs=0.05)
