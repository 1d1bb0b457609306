"""The default method finds the motor that made the data."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.usmbench.identify.conftest import PARAMETERS, WINDOW_S
from usmbench.errors import InputError
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.knots import dead_zone_deg
from usmbench.identify.lag_family import LagFamily
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.linear import dead_time_s, free_run, time_constant_s
from usmbench.model.simulate import simulate
from usmbench.runs.record import Record

Measure = Callable[..., Record]


def test_lag_dead_time_and_dead_zone_are_found(measure: Measure, curve: StaticCurve) -> None:
    model = identify_fast([measure()], FastOptions()).model
    assert time_constant_s(model.linear) == pytest.approx(0.0035, rel=0.02)
    assert dead_time_s(model.linear) == pytest.approx(0.0015, abs=3e-5)
    assert model.linear.gain == pytest.approx(1.0, abs=1e-12)
    assert model.points[0].dead_zone_deg == pytest.approx(dead_zone_deg(curve), abs=0.5)


def test_free_run_of_an_unseen_run_is_within_a_tenth_of_the_noise(measure: Measure) -> None:
    model = identify_fast([measure(4000)], FastOptions()).model
    unseen = measure(2000, seed=7)
    simulation = simulate(model, unseen.phase_deg, measured_rad_s=unseen.speed_rad_s)
    error = (unseen.speed_rad_s - simulation.speed_rad_s)[simulation.inside]
    assert np.sqrt(np.mean(error**2)) < 1.1 * 0.02


@pytest.mark.parametrize("levels", [5, 7, 9, 11])
def test_a_few_levels_are_followed(measure: Measure, curve: StaticCurve, levels: int) -> None:
    """Fewer phases than a dead zone and two slopes have bends: the curve goes through them all."""
    rng = np.random.default_rng(levels)
    phase_deg = np.repeat(rng.permutation(np.resize(np.linspace(-90.0, 90.0, levels), 60)), 5)
    linear = LagFamily(1.0).dynamics(PARAMETERS).linear_part(WINDOW_S)
    clean = free_run(linear, curve.speed_rad_s(phase_deg))
    noisy = clean + 0.02 * rng.standard_normal(clean.size)
    record = replace(measure(300), phase_deg=phase_deg, speed_rad_s=noisy)
    model = identify_fast([record], FastOptions()).model
    simulation = simulate(model, phase_deg, measured_rad_s=noisy)
    assert np.sqrt(np.mean((noisy - simulation.speed_rad_s) ** 2)) < 1.1 * 0.02


def test_one_per_cent_of_wild_samples_changes_little(measure: Measure) -> None:
    record = measure(3000)
    rng = np.random.default_rng(1)
    speed_rad_s = record.speed_rad_s.copy()
    hit = rng.choice(speed_rad_s.size, 30, replace=False)
    speed_rad_s[hit] += rng.normal(0.0, 8.0, 30)
    clean = identify_fast([record], FastOptions()).model
    wild = identify_fast([replace(record, speed_rad_s=speed_rad_s)], FastOptions()).model
    grid_deg = np.linspace(-88.0, 88.0, 200)
    difference = clean.points[0].curve.speed_rad_s(grid_deg) - wild.points[0].curve.speed_rad_s(
        grid_deg
    )
    assert np.sqrt(np.mean(difference**2)) < 0.02
    assert time_constant_s(wild.linear) == pytest.approx(0.0035, rel=0.03)


def test_several_runs_count_together(measure: Measure) -> None:
    found = identify_fast([measure(600, seed=1), measure(600, seed=2)], FastOptions())
    assert sum(score.n for score in found.scores) == 1200
    assert len(found.model.fitted_on) == 2
    assert time_constant_s(found.model.linear) == pytest.approx(0.0035, rel=0.05)


def test_each_operating_point_has_its_curve_and_shares_the_dynamics(measure: Measure) -> None:
    runs = [
        measure(1200, seed=1, point=(41_000.0, 0.0)),
        measure(1200, seed=2, gain=0.5, point=(42_000.0, 0.0)),
    ]
    found = identify_fast(runs, FastOptions())
    fast, slow = (point.curve.speed_rad_s(np.array([60.0]))[0] for point in found.model.points)
    assert slow == pytest.approx(0.5 * fast, rel=0.02)
    middle = simulate(found.model, np.full(50, 60.0), np.full(50, 41_500.0), np.zeros(50))
    assert middle.speed_rad_s[-1] == pytest.approx(0.5 * (fast + slow), rel=1e-6)
    content = found.to_json()
    assert [point["frequency_hz"] for point in content["points"]] == [41_000.0, 42_000.0]
    assert content["points"][0]["a"] == content["points"][1]["a"]


def staircase(edge_deg: float, seed: int, gain: float = 1.0) -> tuple[Record, np.ndarray]:
    """Return a staircase up and down, with noise where the motor turns, and its settled speeds."""
    phases_deg = np.linspace(-90.0, 90.0, 41)
    phase_deg = np.repeat(np.r_[phases_deg, phases_deg[-2::-1]], 20)
    driven_deg = np.maximum(np.abs(phase_deg) - edge_deg, 0.0) * 90.0 / (90.0 - edge_deg)
    settled = gain * 10.0 * np.sign(phase_deg) * np.sin(np.radians(driven_deg))
    linear = LagFamily(1.0).dynamics(np.array([np.log(0.35), 0.15])).linear_part(0.01)
    n = phase_deg.size
    noise = np.random.default_rng(seed).normal(0.0, 0.005, n) * (settled != 0.0)
    record = Record(
        f"run {seed}",
        0.01 * np.arange(1.0, n + 1.0),
        phase_deg,
        free_run(linear, settled) + noise,
        np.full(n, 0.01),
        torque_nm=np.full(n, 0.1 * seed),
    )
    return record, settled


@pytest.mark.parametrize("edge_deg", [4.6, 6.0, 8.9])
def test_dwells_at_the_edge_of_the_dead_zone_are_no_outliers(edge_deg: float) -> None:
    record, settled = staircase(edge_deg, 0)
    curve = identify_fast([record], FastOptions()).model.points[0].curve
    assert np.max(np.abs(curve.speed_rad_s(record.phase_deg) - settled)) < 0.02


def test_a_curve_is_held_no_stiffer_for_the_company_of_others() -> None:
    runs = [staircase(6.0, k, 0.95**k) for k in range(9)]
    (first, settled), records = runs[0], [record for record, _ in runs]
    off = []
    for together in (records[:1], records):
        curve = identify_fast(together, FastOptions(degree=24)).model.points[0].curve
        off.append(np.sqrt(np.mean((curve.speed_rad_s(first.phase_deg) - settled) ** 2)))
    assert off[1] < 1.2 * off[0]


def test_what_the_motor_did_before_the_record_does_not_matter(measure: Measure) -> None:
    record = measure(800)
    late = replace(
        record,
        **{name: getattr(record, name)[3:] for name in ("phase_deg", "speed_rad_s", "window_s")},
        t_s=record.t_s[:-3],
    )
    found = identify_fast([late], FastOptions())
    assert found.scores[0].rmse_free_run_rad_s < 0.022


def test_free_orders_reach_the_same_fit(measure: Measure) -> None:
    lag = identify_fast([measure()], FastOptions(degree=18))
    free = identify_fast([measure()], FastOptions(degree=18, na=1, nb=2))
    assert free.model.linear.b.size == 3
    assert free.scores[0].sse == pytest.approx(lag.scores[0].sse, rel=0.02)


@pytest.mark.parametrize("nb", [None, 0, 1])
def test_a_motor_without_memory_needs_no_past_speeds(nb: int | None) -> None:
    record, settled = staircase(6.0, 0)
    speed_rad_s = settled + np.random.default_rng(3).normal(0.0, 0.005, settled.size)
    speed_rad_s[0] = 0.0  # it starts from rest
    found = identify_fast([replace(record, speed_rad_s=speed_rad_s)], FastOptions(na=0, nb=nb))
    linear, curve = found.model.linear, found.model.points[0].curve
    assert (linear.a.size, linear.dead_time_windows) == (0, 0)
    assert linear.b[0] == pytest.approx(1.0, abs=0.01)
    assert np.max(np.abs(curve.speed_rad_s(record.phase_deg) - settled)) < 0.03


def test_whole_windows_of_dead_time_are_found(measure: Measure) -> None:
    record = measure()
    late = replace(
        record, speed_rad_s=np.r_[np.full(3, record.speed_rad_s[0]), record.speed_rad_s[:-3]]
    )
    model = identify_fast([late], FastOptions()).model
    assert model.linear.dead_time_windows == 3
    assert dead_time_s(model.linear) == pytest.approx(0.0315, abs=1e-4)


def test_a_long_record_is_polished_over_every_row(measure: Measure, curve: StaticCurve) -> None:
    knots = tuple(curve.knots_deg.tolist())
    record = measure(60_000, noise_rad_s=0.2)
    found = identify_fast([record], FastOptions(knots_deg=knots))
    low_s, high_s = found.model.intervals["tau_s"]
    assert low_s < 0.0035 < high_s
    assert high_s - low_s < 1e-4
    band = found.model.intervals["points"][0]["band"]
    low, high = np.array(band["low_rad_s"]), np.array(band["high_rad_s"])
    truth = curve.speed_rad_s(np.array(band["phase_deg"]))
    assert np.max(high - low) < 0.08
    assert np.mean((low < truth) & (truth < high)) > 0.8


def test_knots_are_taken_as_given(measure: Measure, curve: StaticCurve) -> None:
    knots = tuple(curve.knots_deg.tolist())
    found = identify_fast([measure()], FastOptions(knots_deg=knots))
    assert found.to_json()["knots_deg"] == list(knots)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda r: replace(r, phase_deg=np.full(r.t_s.size, 30.0)), "the phase is 30°"),
        (lambda r: replace(r, speed_rad_s=np.where(r.t_s < 0.05, np.nan, 1.0)), "row 0 is nan"),
    ],
)
def test_bad_data_is_one_clear_line(
    measure: Measure, change: Callable[[Record], Record], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        identify_fast([change(measure(200))], FastOptions())


def test_too_few_rows_are_refused_with_the_numbers(measure: Measure) -> None:
    with pytest.raises(InputError, match="60 rows cannot carry 68 parameters"):
        identify_fast([measure(60)], FastOptions(degree=64))


def test_rows_farther_apart_than_a_window_lasts_are_said_to_be(measure: Measure) -> None:
    record = measure(400)
    sparse = replace(record, window_s=np.full(400, 0.01 * float(record.window_s[0])))
    with pytest.raises(InputError, match="follow each other: a window is said to last"):
        identify_fast([sparse], FastOptions())


def test_phases_outside_the_given_knots_are_refused(measure: Measure) -> None:
    with pytest.raises(InputError, match="outside the knots -45…45°"):
        identify_fast([measure(200)], FastOptions(knots_deg=(-45.0, -20.0, 0.0, 20.0, 45.0)))


def test_knots_that_do_not_rise_are_refused(measure: Measure) -> None:
    with pytest.raises(InputError, match="the knots must rise: knot 3"):
        identify_fast([measure(200)], FastOptions(knots_deg=(-90.0, 0.0, 0.0, 20.0, 90.0)))


def test_a_jump_in_time_cuts_the_run_with_a_warning(measure: Measure) -> None:
    record = measure(800)
    t_s = record.t_s.copy()
    t_s[400:] += 5.0
    found = identify_fast([replace(record, t_s=t_s)], FastOptions())
    assert "time jumps at 1 rows (first at row 400" in found.warnings[0]
    assert found.scores[0].rmse_free_run_rad_s < 0.022


def test_runs_of_different_windows_are_refused(measure: Measure) -> None:
    other = replace(measure(200, seed=1), window_s=np.full(200, 0.02))
    with pytest.raises(InputError, match="windows of 20 ms"):
        identify_fast([measure(200), other], FastOptions())
