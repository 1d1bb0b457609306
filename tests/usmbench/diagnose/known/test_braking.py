"""A motor that brakes faster than it runs up, which no model of one lag can show."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from known_motor import identified
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.effects.first_order import first_order
from usmbench.runs.record import Record

Array = NDArray[np.float64]

WINDOW_S, STEPS = 0.01, 250  # steps a window
STAIRS_DEG = np.repeat(np.r_[np.arange(-84.0, 85.0, 6.0), np.arange(84.0, -85.0, -6.0)], 8)


def _turned_rad_s(settled_rad_s: Array, up_s: float, down_s: float, delay_s: float) -> Array:
    """Return mean speeds of windows, by many small steps of a rotor."""
    step_s = WINDOW_S / STEPS
    late = np.full(round(delay_s / step_s), settled_rad_s[0])
    commanded = np.append(late, np.repeat(settled_rad_s, STEPS))[: STEPS * settled_rad_s.size]
    follows_up, follows_down = (-np.expm1(-step_s / tau_s) for tau_s in (up_s, down_s))
    speed, course = float(commanded[0]), []
    for to in commanded.tolist():
        brakes = abs(to) < abs(speed) or to * speed < 0.0
        before = speed
        speed += (follows_down if brakes else follows_up) * (to - speed)
        course.append(0.5 * (before + speed))
    means: Array = np.reshape(course, (-1, STEPS)).mean(axis=1)
    return means


def _record(phase_deg: Array, settled_rad_s: Array, seed: int, noise_rad_s: float) -> Record:
    noise = noise_rad_s * np.random.default_rng([seed, 5]).standard_normal(phase_deg.size)
    speed = _turned_rad_s(settled_rad_s, 0.0055, 0.0033, 0.0012) + noise
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    return Record(f"run {seed}", t_s, phase_deg, speed, np.full(t_s.size, WINDOW_S))


def _settled_rad_s(phase_deg: Array) -> Array:
    """Return settled speeds of a motor that starts at 8 degrees one way and at 11 the other."""
    beyond_deg = np.maximum(np.abs(phase_deg) - np.where(phase_deg > 0.0, 8.0, 11.0), 0.0)
    settled: Array = 10.0 * np.sign(phase_deg) * np.tanh(beyond_deg / 30.0)
    return settled


def test_a_time_constant_of_braking_has_a_shape_of_its_own() -> None:
    plain = identified()
    model = replace(plain, linear=first_order(0.004, 0.0012, WINDOW_S))
    phase_deg = np.repeat(np.random.default_rng(2).uniform(-88.0, 88.0, 100), 8)
    settled = model.points[0].curve.speed_rad_s(phase_deg)
    changed = _turned_rad_s(settled, 0.004, 0.00396, 0.0012)
    changed -= _turned_rad_s(settled, 0.004, 0.004, 0.0012)
    record = Record(
        "run",
        WINDOW_S * np.arange(1.0, phase_deg.size + 1.0),
        phase_deg,
        settled,
        np.full(phase_deg.size, WINDOW_S),
    )
    ((stretch,), _) = cut_runs([record], model, ())
    features = features_of([stretch])
    (column,) = (
        c for c, g in zip(features.columns(stretch), features.groups, strict=True) if g == "braking"
    )
    assert np.max(np.abs(changed)) > 0.01
    np.testing.assert_allclose(-0.01 * column, changed, atol=5e-4)


def test_by_another_plan_it_is_no_news() -> None:
    """Stays from rest, either way, and back to it."""
    stairs_deg = np.resize(STAIRS_DEG, 1800)
    settled = _settled_rad_s(stairs_deg)
    days = [_record(stairs_deg, settled, seed, 0.02) for seed in (1, 2, 3)]
    model = with_knowledge(identify_fast(days, FastOptions()).model, days)
    rng = np.random.default_rng(4)
    other_deg = rng.uniform(-88.0, 88.0, 225)
    other_deg[1::2] = 0.0
    phase_deg = np.repeat(other_deg, 8)
    found = diagnose([_record(phase_deg, _settled_rad_s(phase_deg), 9, 0.02)], model)
    assert found.verdict == "no_discrepancy"
