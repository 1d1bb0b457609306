"""Speeds that are read at the ends of windows, as the paper's difference equation has them."""

from collections.abc import Callable

import numpy as np
import pytest

from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.effects.first_order import lag_of
from usmbench.model.hammerstein import LinearPart, StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Measure = Callable[..., Record]


def _sampled(curve: StaticCurve, pole: float, late: int, noise_rad_s: float = 0.02) -> Record:
    """Return a run of ω_k = p ω_{k−1} + (1 − p) v(φ_{k−late}) with a little noise."""
    rng = np.random.default_rng(3)
    phase_deg = np.repeat(rng.uniform(-90.0, 90.0, 300), 5)
    linear = LinearPart(np.array([-pole]), np.array([1.0 - pole]), late, 0.005)
    clean = free_run(linear, curve.speed_rad_s(phase_deg))
    n = phase_deg.size
    noisy = clean + noise_rad_s * rng.standard_normal(n)
    return Record("sampled", 0.005 * np.arange(1.0, n + 1.0), phase_deg, noisy, np.full(n, 0.005))


@pytest.mark.parametrize(("pole", "late"), [(0.25, 0), (0.5, 0), (0.25, 1)])
def test_the_papers_equation_is_found(curve: StaticCurve, pole: float, late: int) -> None:
    found = identify_fast([_sampled(curve, pole, late)], FastOptions())
    lag = lag_of(found.model.linear, 0.005)
    assert lag is not None
    assert lag.sampled
    assert np.exp(-0.005 / lag.tau_s) == pytest.approx(pole, abs=0.01)
    assert lag.delay_s == pytest.approx(0.005 * late, abs=5e-5)
    assert found.scores[0].rmse_free_run_rad_s < 0.022
    said = found.to_json()
    assert said["dead_time_s"] == pytest.approx(0.005 * late, abs=5e-5)
    low_s, high_s = found.model.intervals["dead_time_s"]
    assert low_s <= said["dead_time_s"] <= high_s


def test_no_noise_is_needed(curve: StaticCurve) -> None:
    found = identify_fast([_sampled(curve, 0.4, 0, 0.0)], FastOptions())
    lag = lag_of(found.model.linear, 0.005)
    assert lag is not None
    assert lag.sampled


def test_averages_stay_averages(measure: Measure) -> None:
    lag = lag_of(identify_fast([measure()], FastOptions()).model.linear, 0.01)
    assert lag is not None
    assert not lag.sampled


@pytest.mark.parametrize("n_steps", [4, 10, 20, 50])
def test_averages_of_whole_steps_stay_averages(curve: StaticCurve, n_steps: int) -> None:
    # Such a simulation acts on a step from its start: half a step sooner than a motor.
    rng = np.random.default_rng(4)
    phase_deg = np.repeat(rng.uniform(-90.0, 90.0, 300), 5)
    left = np.exp(-2.0 / n_steps)
    steps = LinearPart(np.array([-left]), np.array([1.0 - left]), 0, 0.01 / n_steps)
    fine = free_run(steps, np.repeat(curve.speed_rad_s(phase_deg), n_steps))
    n = phase_deg.size
    noisy = fine.reshape(n, n_steps).mean(axis=1) + 1e-4 * rng.standard_normal(n)
    record = Record("steps", 0.01 * np.arange(1.0, n + 1.0), phase_deg, noisy, np.full(n, 0.01))
    found = identify_fast([record], FastOptions())
    lag = lag_of(found.model.linear, 0.01)
    assert lag is not None
    assert not lag.sampled
    assert lag.tau_s == pytest.approx(0.005, rel=0.02)
    assert found.to_json()["dead_time_s"] == 0.0


def test_less_noise_never_widens_the_intervals_of_a_dead_time_of_a_whole_window(
    curve: StaticCurve,
) -> None:
    def half_widths(noise_rad_s: float) -> float:
        found = identify_fast([_sampled(curve, 0.4, 1, noise_rad_s)], FastOptions())
        ends = np.array(found.model.intervals["b"])
        return float(np.max(ends[:, 1] - ends[:, 0]))

    assert half_widths(1e-4) < half_widths(1e-3) < half_widths(1e-2) < 0.01
