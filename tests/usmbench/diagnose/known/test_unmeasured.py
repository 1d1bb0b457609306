"""Where a curve was not measured."""

import numpy as np
import pytest

from usmbench.diagnose.known.unmeasured import (
    by_chance_rad_s,
    short_of_ends_deg,
    unheld_rad_s,
)


def test_few_rows_tell_a_curve_no_better_than_their_scatter() -> None:
    rng = np.random.default_rng(4)
    rows_deg = np.r_[np.linspace(0.0, 10.0, 401), 30.0, 30.0]
    left, nodes_deg = 0.1 * rng.standard_normal(403), (0.0, 5.0, 10.0, 30.0, 50.0)
    off = by_chance_rad_s(nodes_deg, rows_deg, [np.ones(403)], left)
    assert off[3] == pytest.approx(0.1 / np.sqrt(2.0), rel=0.2)
    assert off[4] == pytest.approx(0.1, rel=0.2)
    assert off[1] == pytest.approx(0.1 / np.sqrt(200.0), rel=0.2)
    # Half of the rows are at another operating point, whose curve they tell.
    here = np.arange(403, dtype=np.float64) % 2.0
    both = by_chance_rad_s(nodes_deg, rows_deg, [here, 1.0 - here], left)
    assert both[1] == pytest.approx(np.sqrt(2.0) * off[1], rel=0.02)


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
