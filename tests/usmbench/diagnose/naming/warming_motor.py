"""A motor that loses speed as it warms, and runs that begin cold or warm."""

from functools import cache

import numpy as np

from known_motor import CURVE, LINEAR, NOISE_RAD_S, WINDOW_S
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

CONSTANT_S, LOSES = 15.0, 0.02


def driven(
    seed: int, begins: float = 0.0, *, loses: float = LOSES, drag_rad_s: float = 0.0
) -> Record:
    """Return a run of 25 s of a motor that loses speed as it warms."""
    rng = np.random.default_rng(seed)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, 500), 5)
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    warm = 1.0 - (1.0 - begins) * np.exp(-t_s / CONSTANT_S)
    settled = CURVE.speed_rad_s(phase_deg) * (1.0 - loses * warm)
    settled = np.sign(settled) * np.maximum(np.abs(settled) - drag_rad_s, 0.0)
    speed = free_run(LINEAR, settled, float(settled[0]))
    noisy = speed + NOISE_RAD_S * rng.standard_normal(t_s.size)
    return Record(f"run {seed}", t_s, phase_deg, noisy, np.full(t_s.size, WINDOW_S))


@cache
def known_cold() -> HammersteinModel:
    """Return the model that five runs from cold give."""
    cold = [driven(k) for k in range(5)]
    return with_knowledge(identify_fast(cold, FastOptions(12)).model, cold)
