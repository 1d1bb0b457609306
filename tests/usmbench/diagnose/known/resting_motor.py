"""A motor that warms as it runs, and rests halfway."""

from dataclasses import replace
from functools import cache

import numpy as np
from scipy.signal import lfilter

from known_motor import CURVE, LINEAR, NOISE_RAD_S, WINDOW_S
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

N, AT, RESTS = 6000, 3000, 5
LOSES, CONSTANT_S = 0.02, 30.0


def day(seed: int, pause_s: float = 0.0, *, says: bool = True, goes_on: bool = False) -> Record:
    """Return a run from cold with a pause halfway, in which the motor stands unless it goes on."""
    rng = np.random.default_rng(seed)
    unseen = round(pause_s / WINDOW_S)
    on, seen = np.ones(N + unseen), np.ones(N + unseen, dtype=np.bool_)
    seen[AT : AT + unseen] = False
    if pause_s and not goes_on:
        on[AT : AT + unseen + RESTS] = 0.0
    kept = np.exp(-WINDOW_S / CONSTANT_S)
    warm = lfilter([1.0 - kept], [1.0, -kept], on)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, on.size // 10 + 1), 10)[: on.size] * on
    settled = CURVE.speed_rad_s(phase_deg) * (1.0 - LOSES * warm) * on
    speed = free_run(LINEAR, settled) + NOISE_RAD_S * rng.standard_normal(on.size)
    t_s = WINDOW_S * np.arange(1.0, on.size + 1.0)
    whole = Record(f"run {seed}", t_s, phase_deg, speed, np.full(on.size, WINDOW_S))
    if says:
        whole = replace(whole, extra={"drive_on": on})
    elif pause_s:
        seen &= on > 0.0
    return whole.rows(seen)


@cache
def model(seed: int) -> HammersteinModel:
    runs = [day(100 * seed + k) for k in range(3)]
    return with_knowledge(identify_fast(runs, FastOptions(12)).model, runs)
