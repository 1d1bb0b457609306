"""Lags of runs that do not tell them from dead times."""

import numpy as np
import pytest

from benchmarks.plain_motor import Wrong, motor_of, speed_rad_s
from benchmarks.plain_runs import plan_deg
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.result import Identification
from usmbench.runs.record import Record

WINDOW_S, N = 0.005, 1200


def _identified(
    kind: str, seed: int, delay_s: float = 0.0, noise_rad_s: float = 0.03
) -> tuple[Identification, float]:
    """Return what a run tells, and the motor's time constant."""
    rng = np.random.default_rng(seed)
    motor, phase_deg = motor_of(rng), plan_deg(kind, N, 70.0, rng)
    late = Wrong("transport_delay", delay_s) if delay_s else Wrong()
    speed, _ = speed_rad_s(motor, phase_deg, WINDOW_S, late, rng)
    noisy = speed + noise_rad_s * rng.standard_normal(N)
    t_s = WINDOW_S * np.arange(1.0, N + 1.0)
    record = Record(kind, t_s, phase_deg, noisy, np.full(N, WINDOW_S))
    return identify_fast([record], FastOptions()), motor.lag_s


@pytest.mark.parametrize(("kind", "noise_rad_s"), [("triangle", 0.003), ("sine", 0.03)])
def test_a_phase_that_glides_shows_a_lag_alone(kind: str, noise_rad_s: float) -> None:
    for seed in range(4):
        found, lag_s = _identified(kind, seed, noise_rad_s=noise_rad_s)
        said = found.to_json()
        assert said["dead_time_s"] == pytest.approx(0.0, abs=1e-9)
        assert said["tau_s"] == pytest.approx(lag_s, rel=0.25)
        # What it does not know it says.
        low_s, high_s = found.model.intervals["dead_time_s"]
        assert low_s == 0.0
        assert high_s > 0.015 * noise_rad_s


def test_a_dead_time_that_steps_show_stays() -> None:
    for seed in range(3):
        found, lag_s = _identified("random", seed, delay_s=0.0015)
        said = found.to_json()
        assert said["dead_time_s"] == pytest.approx(0.0015, abs=1e-4)
        assert said["tau_s"] == pytest.approx(lag_s, rel=0.1)
