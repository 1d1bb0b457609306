"""On which samples a curve is chosen."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from benchmarks.plain_motor import motor_of
from tests.usmbench.identify.shaped_runs import shape_of, shaped_run
from usmbench.identify.curve_rows import CurveRows
from usmbench.identify.dynamics import NONE
from usmbench.identify.fast import identify_fast
from usmbench.identify.knots import dead_zone_deg
from usmbench.identify.selection import fitted_curve, judge_knots
from usmbench.identify.shape import FastOptions
from usmbench.model.effects.first_order import first_order
from usmbench.model.linear import free_run
from usmbench.runs.record import Record


def test_dwells_that_settle_choose_the_curve() -> None:
    assert shape_of(shaped_run("staircase", 1500, 0.01)).rows[0].dynamics is NONE


def test_a_glide_chooses_the_curve_between_levels_far_apart() -> None:
    # Ten levels, none in the dead zone: they do not tell that there is one.
    levels_deg = np.array([-88.0, -70.0, -50.0, -40.0, -32.0, 32.0, 40.0, 50.0, 70.0, 88.0])
    held = shaped_run("staircase", 1500, 0.01, given_deg=np.repeat(np.tile(levels_deg, 5), 30))
    shape = shape_of(held, shaped_run("triangle", 1500, 0.01))
    assert shape.rows[0].dynamics is not NONE
    assert dead_zone_deg(fitted_curve(shape.rows[0], shape.choices[0])) == pytest.approx(
        motor_of(np.random.default_rng(9)).edges_deg * np.array([-1.0, 1.0]), abs=1.0
    )


def test_dwells_too_short_to_settle_choose_nothing() -> None:
    # Only the ends are held twice as long, and settle: two phases say nothing of a curve.
    shape = shape_of(shaped_run("staircase", 8000, 0.0015))
    assert shape.rows[0].dynamics is not NONE
    assert shape.choices[0].knots_deg.size > 4


def test_a_motor_that_stands_in_noise_stands() -> None:
    # Dwells in the dead zone average to next to nothing, but not to 0.
    run = shaped_run("staircase", 4000, 0.01)
    standing_deg = shape_of(run).rows[0].standing_deg
    assert standing_deg is not None
    phases = np.unique(run.phase_deg)
    edges_deg = motor_of(np.random.default_rng(9)).edges_deg
    stands = phases[(phases > -edges_deg[0]) & (phases < edges_deg[1])]
    assert standing_deg == (stands[0], stands[-1])


@pytest.mark.parametrize(
    ("levels_deg", "held"),
    [(np.linspace(-90.0, 90.0, 25), 5), (np.array([-180.0, 45.0, 90.0, 175.0, 180.0]), 20)],
    ids=["a random telegraph, few of whose dwells settle", "few phases all around"],
)
@given(seed=st.integers(0, 999))
@settings(max_examples=2, deadline=None)
def test_a_curve_meets_the_few_phases_that_were_driven(
    levels_deg: NDArray[np.float64], held: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    n, window_s, noise_rad_s = 4000, 0.01, 0.03
    phase_deg = np.repeat(rng.choice(levels_deg, n // held), held)
    drive = np.sin(np.radians(phase_deg))
    settled = 14.0 * np.sign(drive) * np.maximum(np.abs(drive) - 0.3, 0.0)
    speed = free_run(first_order(0.0035, 0.0015, window_s), settled)
    noisy = speed + noise_rad_s * rng.standard_normal(n)
    t_s = window_s * np.arange(1.0, n + 1.0)
    run = Record("run", t_s, phase_deg, noisy, np.full(n, window_s))
    curve = identify_fast([run], FastOptions()).model.points[0].curve
    found, place = np.unique(phase_deg, return_index=True)
    assert curve.speed_rad_s(found) == pytest.approx(settled[place], abs=noise_rad_s)


def test_knots_are_judged_where_no_row_is_used() -> None:
    none = np.full(20, -2)
    phase_deg = np.linspace(-60.0, 60.0, 20)
    rows = CurveRows((phase_deg,), (0.1 * phase_deg,), (none,), NONE, (np.ones(20),))
    assert judge_knots(rows, np.array([-60.0, 0.0, 60.0])).held_out_rad_s == 0.0


@pytest.mark.parametrize("seed", range(2))
def test_a_steep_edge_that_is_driven_densely_is_no_outlier(seed: int) -> None:
    rng, n, window_s = np.random.default_rng([seed, 4]), 3000, 0.01
    edges_deg, rate = rng.uniform(8.0, 12.0, 2), rng.uniform(80.0, 120.0)
    t_s = window_s * np.arange(1.0, n + 1.0)
    phase_deg = np.round(np.abs((rate * t_s) % 360.0 - 180.0) - 90.0, 2)
    edge_deg = np.where(phase_deg > 0.0, edges_deg[0], edges_deg[1])
    settled = np.sqrt(np.maximum(np.abs(phase_deg) - edge_deg, 0.0) / (90.0 - edge_deg))
    speed = free_run(first_order(0.0044, 0.0, window_s), 12.0 * np.sign(phase_deg) * settled)
    noisy = speed + 0.017 * rng.standard_normal(n)
    record = Record("steep", t_s, phase_deg, noisy, np.full(n, window_s))
    found = dead_zone_deg(identify_fast([record], FastOptions()).model.points[0].curve)
    assert found == pytest.approx((-edges_deg[1], edges_deg[0]), abs=0.5)
