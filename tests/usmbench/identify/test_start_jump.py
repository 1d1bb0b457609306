"""A motor that starts with a jump is found to, and one that only bends is not."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from jumping_motor import settled_rad_s
from usmbench.identify.curve_rows import CurveRows
from usmbench.identify.dynamics import NONE
from usmbench.identify.start_jump import start_jumps

Array = NDArray[np.float64]
SPAN_DEG = (-90.0, 90.0)


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
# A phase that is driven lies 0.005 degrees beside the edge; a larger jump lies on the other side.
@example(seed=155, low_deg=-4.0, high_deg=9.125, jumps_rad_s=(1.0, 1.0))
@example(seed=1074, low_deg=-4.932, high_deg=18.921, jumps_rad_s=(1.945, 0.905))
@settings(max_examples=20, deadline=None)
def test_a_jump_on_each_side_is_found_where_it_is(
    seed: int, low_deg: float, high_deg: float, jumps_rad_s: tuple[float, float]
) -> None:
    edges_deg = low_deg, high_deg
    phase_deg, speed_rad_s = measured(seed, edges_deg, jumps_rad_s)
    found = start_jumps(rows(phase_deg, speed_rad_s), SPAN_DEG)
    assert len(found) == 2
    driven_deg = np.sort(phase_deg)
    for jump, edge_deg, height_rad_s in zip(found, edges_deg, jumps_rad_s, strict=True):
        # Driven phases are 0.06 degrees apart on average; between two, nothing tells where.
        beyond = np.searchsorted(driven_deg, edge_deg)
        assert jump.phase_deg - jump.reach_deg <= driven_deg[beyond - 1] + 1e-9
        assert jump.phase_deg + jump.reach_deg >= driven_deg[beyond] - 1e-9
        assert jump.reach_deg < 0.6
        assert jump.height_rad_s == pytest.approx(height_rad_s, rel=0.3)


@given(seed=st.integers(0, 999), low_deg=st.floats(-20.0, -4.0), high_deg=st.floats(4.0, 20.0))
@settings(max_examples=20, deadline=None)
def test_a_sharp_bend_is_no_jump(seed: int, low_deg: float, high_deg: float) -> None:
    assert start_jumps(rows(*measured(seed, (low_deg, high_deg), (0.0, 0.0))), SPAN_DEG) == ()


@given(
    seed=st.integers(0, 999),
    low_deg=st.floats(-20.0, -4.0),
    high_deg=st.floats(4.0, 20.0),
    up_rad_s=st.floats(0.4, 2.0),
)
@settings(max_examples=20, deadline=None)
def test_one_side_may_jump_alone(
    seed: int, low_deg: float, high_deg: float, up_rad_s: float
) -> None:
    phase_deg, speed_rad_s = measured(seed, (low_deg, high_deg), (0.0, up_rad_s))
    (jump,) = start_jumps(rows(phase_deg, speed_rad_s), SPAN_DEG)
    assert jump.phase_deg == pytest.approx(high_deg, abs=jump.reach_deg)


def test_what_never_stands_does_not_start() -> None:
    phase_deg = np.random.default_rng(1).uniform(*SPAN_DEG, 500)
    assert start_jumps(rows(phase_deg, 5.0 + 0.01 * phase_deg), SPAN_DEG) == ()
