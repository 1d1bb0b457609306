"""Where nodes lie along the phase."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.known.gaps import Gaps
from usmbench.diagnose.known.phase_nodes import PHASE_NODES, phase_nodes
from usmbench.diagnose.known.unmeasured import short_of_ends_deg

ALSO_DEG = st.lists(st.floats(-90.0, 90.0), max_size=2)


@given(st.floats(0.0, 1.0), st.floats(1e-12, 1.0), ALSO_DEG)
def test_nodes_are_apart_though_a_curve_does_all_at_one_place(
    at: float, width: float, also_deg: list[float]
) -> None:
    phase_deg = np.linspace(-90.0, 90.0, 2001)
    speed_rad_s = 10.0 * np.tanh((phase_deg - 90.0 * (2.0 * at - 1.0)) / width)
    nodes_deg = np.array(phase_nodes(phase_deg, [speed_rad_s], also_deg=also_deg))
    assert nodes_deg.size == PHASE_NODES
    nearest_deg = [np.min(np.abs(nodes_deg - asked_deg)) for asked_deg in also_deg]
    assert max(nearest_deg, default=0.0) < 0.2
    assert np.all(np.diff(nodes_deg) > 0.0)
    assert (nodes_deg[0], nodes_deg[-1]) == (-90.0, 90.0)


def test_a_node_stands_where_the_drive_stops_short_of_an_end_that_the_warm_up_holds() -> None:
    multisine_deg = 89.0 * np.sin(np.linspace(0.0, 40.0, 2000))
    measured_deg = np.unique(np.r_[multisine_deg, 90.0])
    (short_deg,) = short_of_ends_deg(measured_deg)
    assert short_deg == multisine_deg.max()
    speed_rad_s = np.linspace(-10.0, 10.0, 2001)
    nodes_deg = phase_nodes(
        np.linspace(-89.0, 90.0, 2001), [speed_rad_s], measured_deg, [short_deg]
    )
    assert nodes_deg[-2:] == pytest.approx((short_deg, 90.0))


@given(st.integers(2, 37), st.floats(2.0, 30.0))
def test_nodes_lie_at_measured_phases_where_one_is_near(n: int, corner_deg: float) -> None:
    measured_deg, table_deg = np.linspace(-90.0, 90.0, n), np.linspace(-90.0, 90.0, 2001)
    speed_rad_s = np.copysign(np.maximum(np.abs(table_deg) - corner_deg, 0.0), table_deg)
    nodes_deg = np.array(phase_nodes(table_deg, [speed_rad_s], measured_deg))
    assert np.all(np.diff(nodes_deg) > 0.0)
    away_deg = np.abs(measured_deg[:, None] - nodes_deg).min(axis=1)
    # One that has none of its own would have to share it: nodes are not as dense there.
    assert np.all(away_deg[away_deg > 1e-3] > 0.5)
    off = Gaps.of(measured_deg, table_deg, [speed_rad_s]).at_nodes_rad_s(nodes_deg)
    at_one = np.abs(nodes_deg[:, None] - measured_deg).min(axis=1) < 1e-3
    assert np.all(off[at_one] == 0.0)
