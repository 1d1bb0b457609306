"""On which samples a curve is chosen."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from benchmarks.plain_motor import Wrong, motor_of, speed_rad_s
from benchmarks.plain_runs import plan_deg
from usmbench.identify.curve_rows import CurveRows
from usmbench.identify.dynamics import NONE
from usmbench.identify.fast import identify_fast
from usmbench.identify.gather import from_windows
from usmbench.identify.knots import dead_zone_deg
from usmbench.identify.selection import fitted_curve, judge_knots
from usmbench.identify.shape import FastOptions, Shape, rough_fit, settle_shape
from usmbench.model.effects.first_order import first_order
from usmbench.model.linear import free_run
from usmbench.runs.record import Record


def _run(
    kind: str,
    n: int,
    window_s: float,
    seed: int = 9,
    given_deg: NDArray[np.float64] | None = None,
) -> Record:
    rng = np.random.default_rng(seed)
    motor = motor_of(rng)
    phase_deg = plan_deg(kind, n, 90.0, rng) if given_deg is None else given_deg
    speed, _ = speed_rad_s(motor, phase_deg, window_s, Wrong(), rng)
    noisy = speed + 0.02 * rng.standard_normal(n)
    return Record(kind, window_s * np.arange(1.0, n + 1.0), phase_deg, noisy, np.full(n, window_s))


def _shape(*runs: Record) -> Shape:
    data, options = from_windows(runs), FastOptions()
    return settle_shape(data, rough_fit(data, data, options), options)


def test_dwells_that_settle_choose_the_curve() -> None:
    assert _shape(_run("staircase", 1500, 0.01)).rows[0].dynamics is NONE


@pytest.mark.parametrize("beside", [("multisine",), ("triangle",), ("multisine", "triangle")])
def test_what_glides_between_the_dwells_brings_the_curve_nearer(
    beside: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    def off_rad_s(seed: int) -> float:
        shape = _shape(*(_run(kind, 1500, 0.01, seed) for kind in ("staircase", *beside)))
        table_deg = np.linspace(-88.0, 88.0, 1761)
        found = fitted_curve(shape.rows[0], shape.choices[0]).speed_rad_s(table_deg)
        true_rad_s = motor_of(np.random.default_rng(seed)).settled_rad_s(table_deg)
        return float(np.sqrt(np.mean((found - true_rad_s) ** 2)))

    glided = np.array([off_rad_s(seed) for seed in range(5)])
    monkeypatch.setattr("usmbench.identify.curve_choice._gliding", lambda *_: None)
    share = glided / [off_rad_s(seed) for seed in range(5)]
    assert np.max(share) < 1.05
    assert np.exp(np.mean(np.log(share))) < 0.8


def test_a_glide_chooses_the_curve_between_levels_far_apart() -> None:
    # Ten levels, none in the dead zone: they do not tell that there is one.
    levels_deg = np.array([-88.0, -70.0, -50.0, -40.0, -32.0, 32.0, 40.0, 50.0, 70.0, 88.0])
    held = _run("staircase", 1500, 0.01, given_deg=np.repeat(np.tile(levels_deg, 5), 30))
    shape = _shape(held, _run("triangle", 1500, 0.01))
    assert shape.rows[0].dynamics is not NONE
    assert dead_zone_deg(fitted_curve(shape.rows[0], shape.choices[0])) == pytest.approx(
        motor_of(np.random.default_rng(9)).edges_deg * np.array([-1.0, 1.0]), abs=1.0
    )


def test_dwells_too_short_to_settle_choose_nothing() -> None:
    # Only the ends are held twice as long, and settle: two phases say nothing of a curve.
    shape = _shape(_run("staircase", 8000, 0.0015))
    assert shape.rows[0].dynamics is not NONE
    assert shape.choices[0].knots_deg.size > 4


def test_a_motor_that_stands_in_noise_stands() -> None:
    # Dwells in the dead zone average to next to nothing, but not to 0.
    run = _run("staircase", 4000, 0.01)
    standing_deg = _shape(run).rows[0].standing_deg
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
@settings(max_examples=6, deadline=None)
def test_a_curve_meets_the_few_phases_that_were_driven(
    levels_deg: NDArray[np.float64], held: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    n, window_s, noise_rad_s = 6000, 0.01, 0.03
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
