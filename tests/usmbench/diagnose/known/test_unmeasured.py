"""Where a curve was not measured."""

import numpy as np
import pytest

from usmbench.diagnose.known.unmeasured import short_of_ends_deg, unheld_rad_s, unmeasured_rad_s


def test_a_curve_between_measured_phases_is_as_unsure_as_a_corner_there_would_make_it() -> None:
    table_deg = np.linspace(-90.0, 90.0, 1801)
    corner = 0.2 * np.maximum(table_deg - 14.0, 0.0)
    measured_deg = np.r_[np.arange(-90.0, 0.0, 0.1), np.arange(0.0, 91.0, 10.0)]
    nodes_deg = (-45.03, 3.0, 15.0, 34.0)
    off = unmeasured_rad_s(nodes_deg, measured_deg, table_deg, [corner])
    # From 10 to 20 degrees the slope turns by 0.2: in the middle, a line across is off by 0.5.
    assert off[2] == pytest.approx(0.5, rel=0.01)
    assert (off[0], off[1], off[3]) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert unmeasured_rad_s(nodes_deg, measured_deg[:1], table_deg, [corner]) == (0.0,) * 4


@pytest.mark.parametrize("times", [1, 4, 8])
def test_an_end_that_few_rows_hold_may_be_off(times: int) -> None:
    rows_deg = np.sort(np.r_[np.linspace(-90.0, 40.0, 300), np.full(times, 90.0)])
    low, middle, edge, end = unheld_rad_s((-80.0, 0.0, 60.0, 90.0), rows_deg, 10.0)
    assert low == middle == 0.0
    assert edge == end == pytest.approx(0.5 * (1.0 - times / 8))


@pytest.mark.parametrize("levels_deg", [np.arange(-90.0, 91.0, 10.0), np.array([0.0, 90.0])])
def test_a_drive_that_goes_to_its_ends_by_even_steps_stops_short_of_none(
    levels_deg: np.ndarray,
) -> None:
    assert short_of_ends_deg(levels_deg) == []


def test_where_a_dead_zone_ends_between_two_levels_the_model_cannot_know() -> None:
    table_deg, levels_deg = np.linspace(-90.0, 90.0, 1801), np.arange(-90.0, 91.0, 10.0)
    # The model lets the rotor start at the level itself; it may as well do so at 18, more steeply.
    speed_rad_s = np.interp(table_deg, [10.0, 20.0, 90.0], [0.0, 1.0, 22.0])
    off = unmeasured_rad_s((-5.0, 15.0, 20.0, 45.0), levels_deg, table_deg, [speed_rad_s])
    assert off[1] == pytest.approx(0.25 * 0.3 * 10.0, rel=0.01)
    assert (off[0], off[2], off[3]) == pytest.approx((0.0, 0.0, 0.0), abs=0.05)
