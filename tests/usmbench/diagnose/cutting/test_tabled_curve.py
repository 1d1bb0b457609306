"""A curve in a table is the line through its nodes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.cutting.tabled_curve import NODES_DEG, TabledCurve

SPEEDS = [np.sin(np.radians(NODES_DEG)), np.abs(NODES_DEG), np.cos(NODES_DEG)]


@given(
    st.lists(st.floats(-250.0, 250.0), min_size=1, max_size=20),
    st.lists(st.sampled_from([0.0, 0.3, 1.0]), min_size=3, max_size=3),
)
def test_rows_are_interpolated_and_mixed(phases_deg: list[float], shares: list[float]) -> None:
    phase_deg = np.array(phases_deg)
    weights = [np.full(phase_deg.size, share) for share in shares]
    curve = TabledCurve(SPEEDS, weights, phase_deg)
    expected = sum(
        w * np.interp(phase_deg, NODES_DEG, s) for w, s in zip(weights, SPEEDS, strict=True)
    )
    assert curve(phase_deg) == pytest.approx(expected, abs=1e-9)
    assert curve(phase_deg.copy()) == pytest.approx(expected, abs=1e-9)
