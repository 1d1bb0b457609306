"""Hat functions and turns of polygons over any nodes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.model.polygon import hats, turns

WIDTHS = st.lists(st.floats(0.1, 10.0), min_size=2, max_size=12)


@given(WIDTHS, st.lists(st.floats(-20.0, 200.0), min_size=1, max_size=20))
def test_hats_interpolate_heights_and_hold_the_ends(
    widths: list[float], values: list[float]
) -> None:
    nodes, where = np.r_[0.0, np.cumsum(widths)], np.array(values)
    heights = np.random.default_rng(0).standard_normal(nodes.size)
    combined = np.column_stack(list(hats(where, nodes))) @ heights
    assert combined == pytest.approx(np.interp(where, nodes, heights), abs=1e-9)


@given(WIDTHS, st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_a_slope_turns_where_it_changes_and_by_as_much(
    widths: list[float], before: float, after: float
) -> None:
    nodes = np.r_[0.0, np.cumsum(widths)]
    heights = np.where(nodes < nodes[1], before, after) * (nodes - nodes[1])
    expected = np.r_[after - before, np.zeros(nodes.size - 3)]
    assert turns(nodes) @ heights == pytest.approx(expected, abs=1e-8)
