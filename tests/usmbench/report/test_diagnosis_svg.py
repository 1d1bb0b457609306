"""Axes and lines of the report's drawings."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from usmbench.report.diagnosis_svg import Axis, Panel, data_range

finite = st.floats(-1e6, 1e6)


@given(finite, st.floats(1e-6, 1e6), st.floats(20.0, 200.0))
def test_ticks_are_round_within_the_axis_and_apart(
    low: float, width: float, spacing_px: float
) -> None:
    axis = Axis(low, low + width, 0.0, 400.0)
    if axis.high - axis.low < 1e-9 * max(abs(low), 1.0):
        return
    values = [value for value, _ in axis.ticks(spacing_px)]
    slack = 1e-6 * width + 1e-9 * abs(low)
    assert all(axis.low - slack <= v <= axis.high + slack for v in values)
    steps = np.diff(values) / width * 400.0
    assert np.all(steps >= spacing_px * (1.0 - 1e-3))
    for value, label in axis.ticks(spacing_px):
        assert math.isclose(float(label.replace("−", "-")), value, abs_tol=1e-3 * width + 1e-6)


@given(st.lists(finite, max_size=20))
def test_a_range_holds_its_data_and_is_never_empty(values: list[float]) -> None:
    low, high = data_range(np.array([*values, np.nan, np.inf]))
    assert low < high
    assert all(low <= value <= high for value in values)


def test_a_line_breaks_where_a_point_is_missing() -> None:
    panel = Panel(Axis(0, 10, 0, 100), Axis(0, 10, 100, 0), "x", "y")
    x = np.arange(6.0)
    y = np.array([1.0, 2.0, np.nan, 4.0, 5.0, np.nan])
    assert panel.line(x, y, "before").count("M") == 2
    assert panel.line(x, np.full(6, np.nan), "before") == ""
    assert panel.marks(x, y, "square", "after").count("M") == 4
    assert panel.band(x, y - 1.0, y + 1.0, "band").count("Z") == 1
