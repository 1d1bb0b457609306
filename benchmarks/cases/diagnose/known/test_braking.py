"""A motor that brakes faster than it runs up, which no model of one lag can show."""

import numpy as np
from numpy.typing import NDArray

from tests.usmbench.diagnose.known.braking_rotor import WINDOW_S, turned_rad_s
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.runs.record import Record

Array = NDArray[np.float64]

STAIRS_DEG = np.repeat(np.r_[np.arange(-84.0, 85.0, 6.0), np.arange(84.0, -85.0, -6.0)], 8)


def _record(phase_deg: Array, settled_rad_s: Array, seed: int, noise_rad_s: float) -> Record:
    noise = noise_rad_s * np.random.default_rng([seed, 5]).standard_normal(phase_deg.size)
    speed = turned_rad_s(settled_rad_s, 0.0055, 0.0033, 0.0012) + noise
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    return Record(f"run {seed}", t_s, phase_deg, speed, np.full(t_s.size, WINDOW_S))


def _settled_rad_s(phase_deg: Array) -> Array:
    """Return settled speeds of a motor that starts at 8 degrees one way and at 11 the other."""
    beyond_deg = np.maximum(np.abs(phase_deg) - np.where(phase_deg > 0.0, 8.0, 11.0), 0.0)
    settled: Array = 10.0 * np.sign(phase_deg) * np.tanh(beyond_deg / 30.0)
    return settled


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
