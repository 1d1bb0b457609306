"""Lag and curve are found whatever the window is, short against the lag or long."""

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.linear import dead_time_s, time_constant_s
from usmbench.runs.record import Record

Array = NDArray[np.float64]
Sampled = tuple[Record, float, float]

_FINE = 40  # steps a window
_DRAWS = 4


def _plan(kind: str, n: int, rng: np.random.Generator) -> Array:
    if kind == "few levels":
        levels_deg = np.linspace(-90.0, 90.0, 13)
        return np.resize(np.repeat(np.r_[levels_deg, levels_deg[::-1]], n // 78), n)
    if kind == "triangle":
        return 90.0 - 180.0 * np.abs((np.arange(n) / 250.0) % 2.0 - 1.0)
    tones = np.arange(1, n // 16)
    phase_rad = np.outer(np.arange(n), 4.0 * np.pi * tones / n) + rng.uniform(
        0.0, 2.0 * np.pi, tones.size
    )
    sum_ = np.cos(phase_rad) @ tones**-0.5
    return np.asarray(np.round(90.0 * sum_ / np.max(np.abs(sum_)), 1))


def _sampled(kind: str, windows_a_lag: float, seed: int) -> Sampled:
    """Return a run of a drawn motor, its lag and its noise: an exponential step by fine step."""
    rng = np.random.default_rng([seed, int(1e3 * windows_a_lag)])
    lag_s, n, noise = rng.uniform(0.002, 0.006), int(rng.choice([400, 1500])), 0.02
    edge_deg, reach_deg, top_rad_s = rng.uniform([5.0, 30.0, 5.0], [20.0, 60.0, 12.0])
    window_s = lag_s / windows_a_lag
    phase_deg = _plan(kind, n, rng)
    driven_deg = np.sign(phase_deg) * np.maximum(np.abs(phase_deg) - edge_deg, 0.0)
    settled = np.repeat(top_rad_s * np.tanh(driven_deg / reach_deg), _FINE)
    kept, speed, fine = np.exp(-window_s / _FINE / lag_s), settled[0], np.empty(settled.size)
    for k, goal in enumerate(settled):
        after = goal + kept * (speed - goal)
        fine[k], speed = 0.5 * (speed + after), after
    noisy = fine.reshape(n, _FINE).mean(axis=1) + noise * rng.standard_normal(n)
    t_s = window_s * np.arange(1.0, n + 1.0)
    return Record("drawn", t_s, phase_deg, noisy, np.full(n, window_s)), lag_s, noise


@pytest.mark.parametrize("kind", ["few levels", "triangle", "multisine"])
@pytest.mark.parametrize("windows_a_lag", [0.05, 0.15, 0.5, 1.5, 4.0])
def test_the_free_run_leaves_noise_and_answers_in_time(kind: str, windows_a_lag: float) -> None:
    left = []
    for seed in range(_DRAWS):
        record, lag_s, noise = _sampled(kind, windows_a_lag, seed)
        found = identify_fast([record], FastOptions())
        left.append(found.scores[0].rmse_free_run_rad_s / noise)
        linear = found.model.linear
        # Ramps do not tell a lag from a dead time, and long windows neither.
        answer_s = (time_constant_s(linear) or 0.0) + (dead_time_s(linear) or 0.0)
        assert abs(answer_s - lag_s) < 0.3 * lag_s + 0.05 * lag_s / windows_a_lag
    assert max(left) < 1.6
