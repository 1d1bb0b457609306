"""Runs of a motor that is faster on one day than on another."""

from collections.abc import Callable

import numpy as np
import pytest

from usmbench.identify.design import build_design
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.identify.gather import from_windows
from usmbench.identify.knots import place_knots
from usmbench.identify.lag_family import LagFamily
from usmbench.identify.projected import Projected
from usmbench.identify.robust_fit import counted_alike
from usmbench.identify.run_gains import at_one_gain, run_gains
from usmbench.identify.starting_dynamics import soft_priors
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Measure = Callable[..., Record]
GAINS = (1.02, 0.985, 1.004, 0.991)
LOW, HIGH = (41_000.0, 0.0), (42_000.0, 0.0)


def estimated(runs: list[Record]) -> np.ndarray:
    """Return the gains that runs show at the motor's own dynamics."""
    data = from_windows(runs)
    knots_deg = [place_knots(*span_deg, 24) for span_deg in data.spans_deg]
    stretches = build_design(data, knots_deg)
    start, priors = np.array([np.log(0.35), 0.15]), soft_priors(data, knots_deg)
    rough = Projected(stretches, LagFamily(1.0), start, counted_alike(stretches), priors)
    return run_gains(rough, [s.run for s in data.segments])


def test_gains_are_told_from_their_mean(measure: Measure) -> None:
    runs = [measure(1500, seed=k, gain=gain) for k, gain in enumerate(GAINS)]
    gains = estimated(runs)
    assert np.mean(gains) == pytest.approx(0.0, abs=1e-12)
    assert gains == pytest.approx(np.array(GAINS) / np.mean(GAINS) - 1.0, abs=1e-3)
    (first, *_) = at_one_gain(from_windows(runs), gains).segments
    assert first.speed_rad_s * (1.0 + gains[0]) == pytest.approx(runs[0].speed_rad_s)


def test_a_motor_that_repeats_has_one_gain(measure: Measure) -> None:
    assert np.max(np.abs(estimated([measure(1500, seed=k) for k in range(4)]))) < 5e-4


def test_runs_that_share_no_operating_point_say_nothing(measure: Measure) -> None:
    runs = [measure(1500, seed=1, point=LOW), measure(1500, seed=2, gain=0.9, point=HIGH)]
    assert np.max(np.abs(estimated(runs))) < 1e-4


def test_a_curve_follows_the_phase_and_not_the_runs(measure: Measure, curve: StaticCurve) -> None:
    # Each run drives other phases: a curve through all of them would bend wherever they change.
    spread, repeating = (
        [
            measure(1200, seed=k, dwell=24, noise_rad_s=0.005, gain=gain)
            for k, gain in enumerate(gains)
        ]
        for gains in (GAINS, (1.0,) * len(GAINS))
    )
    phase_deg = np.linspace(-85.0, 85.0, 341)
    true_rad_s = curve.speed_rad_s(phase_deg)
    off = []
    for runs in (spread, repeating):
        found = identify_fast(runs, FastOptions(degree=24)).model.points[0].curve
        speed_rad_s = found.speed_rad_s(phase_deg)
        scale = float(speed_rad_s @ true_rad_s / (true_rad_s @ true_rad_s))
        off.append(float(np.sqrt(np.mean((speed_rad_s / scale - true_rad_s) ** 2))))
    assert off[0] < 1.5 * off[1]


@pytest.mark.parametrize("seed", range(2))
def test_what_a_rough_curve_misses_is_no_gain(seed: int) -> None:
    """A sweep over the whole range, and a closer look at the dead zone, of a motor that repeats."""
    rng = np.random.default_rng([seed, 7])
    sweep_deg = 90.0 * (1.0 - 4.0 * np.abs(np.arange(3000) / 500.0 % 1.0 - 0.5))
    close_deg = np.repeat(rng.uniform(-20.0, 20.0, 600), 5)
    t_s, window_s = 0.01 * np.arange(1.0, 3001.0), np.full(3000, 0.01)
    runs = []
    for name, phase_deg in (("sweep", np.round(sweep_deg, 2)), ("close", close_deg)):
        speed_rad_s = free_run(first_order(0.0035, 0.0015, 0.01), _sharp_rad_s(phase_deg))
        noisy = speed_rad_s + 0.02 * rng.standard_normal(3000)
        runs.append(Record(name, t_s, phase_deg, noisy, window_s))
    curve = identify_fast(runs, FastOptions()).model.points[0].curve
    ends_deg = np.array([-88.0, 88.0])
    assert curve.speed_rad_s(ends_deg) == pytest.approx(_sharp_rad_s(ends_deg), rel=4e-3)


def _sharp_rad_s(phase_deg: np.ndarray) -> np.ndarray:
    """Return speeds that rise at once beyond 8 degrees, and saturate."""
    beyond_deg = np.maximum(np.abs(phase_deg) - 8.0, 0.0)
    return np.asarray(-9.0 * np.sign(phase_deg) * np.expm1(-beyond_deg / 40.0))


def test_a_run_that_is_no_other_day_is_said(measure: Measure) -> None:
    fast, slow, plain = measure(800, seed=1), measure(800, seed=2, gain=0.8), measure(800, seed=3)
    found = identify_fast([fast, slow, plain], FastOptions(degree=12))
    (warning,) = (w for w in found.warnings if "slower" in w)
    assert warning.startswith(f"{slow.name}: 14 % slower than the runs on average")
