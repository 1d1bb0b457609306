"""A torque limit is found where there is one, and only there."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.lag_family import LagFamily
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.linear import dead_time_s, free_run, time_constant_s
from usmbench.model.simulate import simulate
from usmbench.runs.record import Record

Measure = Callable[..., Record]

SLIP_RAD_S, NOISE_RAD_S = 8.0, 0.02
LAG = LagFamily(1.0).dynamics(np.array([np.log(0.35), 0.15]))
LIMITED = replace(LAG, slip_limit_rad_s=SLIP_RAD_S).linear_part(0.01)


def limited_run(measure: Measure, curve: StaticCurve, seed: int = 0, n: int = 3000) -> Record:
    """Return a run of the motor with the same lag and a torque limit."""
    record = measure(n, seed=seed)
    clean = free_run(LIMITED, curve.speed_rad_s(record.phase_deg))
    rng = np.random.default_rng(100 + seed)
    return replace(record, speed_rad_s=clean + NOISE_RAD_S * rng.standard_normal(n))


def test_the_limit_is_found_with_an_interval(measure: Measure, curve: StaticCurve) -> None:
    found = identify_fast([limited_run(measure, curve)], FastOptions())
    linear = found.model.linear
    assert linear.slip_limit_rad_s == pytest.approx(SLIP_RAD_S, rel=0.02)
    assert time_constant_s(linear) == pytest.approx(0.0035, rel=0.02)
    assert dead_time_s(linear) == pytest.approx(0.0015, abs=3e-5)
    for name, truth in (
        ("slip_limit_rad_s", SLIP_RAD_S),
        ("tau_s", 0.0035),
        ("dead_time_s", 0.0015),
    ):
        low, high = found.model.intervals[name]
        reach = 0.5 * (high - low)
        assert abs(truth - 0.5 * (low + high)) < 2.0 * reach
        assert reach < 0.05 * truth
    assert found.to_json()["slip_limit_rad_s"] == linear.slip_limit_rad_s
    assert not found.model.unexplained


@pytest.mark.parametrize("dead", [0.02, 0.08])
def test_a_dead_time_shorter_than_what_averages_may_come_too_soon_by_is_found(
    measure: Measure, curve: StaticCurve, dead: float
) -> None:
    # To the plain lag that the search begins with, a limited motor seems to come too soon.
    record = measure(3000, seed=4)
    lag = LagFamily(1.0).dynamics(np.array([np.log(0.27), dead]))
    limited = replace(lag, slip_limit_rad_s=SLIP_RAD_S).linear_part(0.01)
    clean = free_run(limited, curve.speed_rad_s(record.phase_deg))
    noise = NOISE_RAD_S * np.random.default_rng(104).standard_normal(3000)
    linear = identify_fast([replace(record, speed_rad_s=clean + noise)], FastOptions()).model.linear
    assert linear.slip_limit_rad_s == pytest.approx(SLIP_RAD_S, rel=0.03)
    assert time_constant_s(linear) == pytest.approx(0.0027, rel=0.02)
    assert dead_time_s(linear) == pytest.approx(0.01 * dead, abs=6e-5)


def test_many_small_steps_do_not_hide_the_limit(measure: Measure, curve: StaticCurve) -> None:
    large, gentle = limited_run(measure, curve, n=600), []
    for seed in range(1, 9):
        phase_deg = 60.0 * (seed % 2) - 30.0 + 0.04 * np.repeat(np.arange(300.0), 5)
        quiet_rad_s = 0.1 * NOISE_RAD_S * np.random.default_rng(seed).standard_normal(1500)
        speed_rad_s = free_run(LIMITED, curve.speed_rad_s(phase_deg)) + quiet_rad_s
        record = measure(1500, seed=seed)
        gentle.append(replace(record, phase_deg=phase_deg, speed_rad_s=speed_rad_s))
    linear = identify_fast([large, *gentle], FastOptions()).model.linear
    assert linear.slip_limit_rad_s == pytest.approx(SLIP_RAD_S, rel=0.05)


def dwells_of_50(curve: StaticCurve, phases_deg: NDArray[np.float64]) -> Record:
    """Return a run of the limited motor: two blocks of 25 rows are a dwell."""
    phase_deg = np.repeat(phases_deg, 50)
    noise_rad_s = NOISE_RAD_S * np.random.default_rng(9).standard_normal(phase_deg.size)
    speed_rad_s = free_run(LIMITED, curve.speed_rad_s(phase_deg)) + noise_rad_s
    windows_s = np.full(phase_deg.size, 0.01)
    return Record("run", np.cumsum(windows_s), phase_deg, speed_rad_s, windows_s)


def test_long_dwells_do_not_hide_the_limit(curve: StaticCurve) -> None:
    phases_deg = np.random.default_rng(9).uniform(-88.0, 88.0, 90)
    linear = identify_fast([dwells_of_50(curve, phases_deg)], FastOptions()).model.linear
    assert linear.slip_limit_rad_s == pytest.approx(SLIP_RAD_S, rel=0.05)


def test_stretches_of_two_dwells_show_the_limit(curve: StaticCurve) -> None:
    phases_deg = np.random.default_rng(9).uniform(-88.0, 88.0, 40)
    record = dwells_of_50(curve, phases_deg)
    jumps_s = np.repeat(np.arange(20.0), 100)
    found = identify_fast([replace(record, t_s=record.t_s + jumps_s)], FastOptions())
    assert found.model.linear.slip_limit_rad_s == pytest.approx(SLIP_RAD_S, rel=0.05)


@pytest.mark.parametrize(("visits", "found"), [(1, False), (4, True)])
def test_one_large_step_alone_shows_no_limit(
    curve: StaticCurve, visits: int, *, found: bool
) -> None:
    up_deg = np.arange(-85.0, 86.0, 5.0)
    record = dwells_of_50(curve, np.r_[up_deg, np.tile([-85.0, 85.0], visits)[1:], up_deg[::-1]])
    linear = identify_fast([record], FastOptions()).model.linear
    assert (linear.slip_limit_rad_s is not None) == found


def test_an_unseen_run_is_met_to_the_noise(measure: Measure, curve: StaticCurve) -> None:
    model = identify_fast([limited_run(measure, curve)], FastOptions()).model
    unseen = limited_run(measure, curve, seed=5)
    simulation = simulate(model, unseen.phase_deg, measured_rad_s=unseen.speed_rad_s)
    error = (unseen.speed_rad_s - simulation.speed_rad_s)[simulation.inside]
    assert np.sqrt(np.mean(error**2)) < 1.1 * NOISE_RAD_S


@pytest.mark.parametrize("seed", range(3))
def test_a_linear_motor_gets_none(measure: Measure, seed: int) -> None:
    found = identify_fast([measure(3000, seed=seed)], FastOptions())
    assert found.model.linear.slip_limit_rad_s is None
    assert found.model.intervals["slip_limit_rad_s"] is None


def test_orders_that_the_user_fixed_stay_linear(measure: Measure, curve: StaticCurve) -> None:
    found = identify_fast([limited_run(measure, curve)], FastOptions(na=1, nb=2))
    assert found.model.linear.slip_limit_rad_s is None
