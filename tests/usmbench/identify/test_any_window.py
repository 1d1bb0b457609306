"""Lag and curve are found whatever the window is, short against the lag or long."""

import numpy as np
import pytest

from benchmarks.plain_motor import Wrong, motor_of, speed_rad_s
from benchmarks.plain_runs import plan_deg
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.linear import dead_time_s, time_constant_s
from usmbench.runs.record import Record

_NOISE_RAD_S = 0.02


def _sampled(kind: str, windows_a_lag: float, seed: int) -> tuple[Record, float]:
    """Return a run of a drawn motor, and its lag."""
    rng = np.random.default_rng([seed, int(1e3 * windows_a_lag)])
    motor, n = motor_of(rng), int(rng.choice([400, 1500]))
    window_s = motor.lag_s / windows_a_lag
    phase_deg = plan_deg(kind, n, 90.0, rng)
    speed, _ = speed_rad_s(motor, phase_deg, window_s, Wrong(), rng)
    noisy = speed + _NOISE_RAD_S * rng.standard_normal(n)
    t_s = window_s * np.arange(1.0, n + 1.0)
    return Record("drawn", t_s, phase_deg, noisy, np.full(n, window_s)), motor.lag_s


@pytest.mark.parametrize("kind", ["staircase", "triangle", "multisine"])
@pytest.mark.parametrize("windows_a_lag", [0.05, 0.5, 4.0])
def test_the_free_run_leaves_noise_and_answers_in_time(kind: str, windows_a_lag: float) -> None:
    record, lag_s = _sampled(kind, windows_a_lag, 0)
    found = identify_fast([record], FastOptions())
    linear = found.model.linear
    # Ramps do not tell a lag from a dead time, and long windows neither.
    answer_s = (time_constant_s(linear) or 0.0) + (dead_time_s(linear) or 0.0)
    assert abs(answer_s - lag_s) < 0.3 * lag_s + 0.05 * lag_s / windows_a_lag
    assert found.scores[0].rmse_free_run_rad_s < 2.5 * _NOISE_RAD_S
