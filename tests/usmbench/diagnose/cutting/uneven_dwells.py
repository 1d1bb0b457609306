"""Runs whose dwells are no whole number of windows."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from known_motor import CURVE, WINDOW_S
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Array = NDArray[np.float64]
FINE = 40  # parts of a window
LEVELS_DEG = np.linspace(-88.0, 88.0, 24)
UP_AND_DOWN_DEG = np.r_[LEVELS_DEG, LEVELS_DEG[-2:0:-1]]


def commanded_deg(dwell_windows: float, n: int, begun: float = 0.0) -> Array:
    """Return the phase at the end of each of n windows, and in each of their parts."""
    into = (np.arange(n * FINE) + 0.5) / FINE + begun * dwell_windows
    phase_deg: Array = UP_AND_DOWN_DEG[(into // dwell_windows).astype(int) % UP_AND_DOWN_DEG.size]
    return phase_deg


def dwelling_run(seed: int, dwell_windows: float = 4.37, late_s: float = 0.0) -> Record:
    n, rng = 3000, np.random.default_rng(seed)
    phase_deg = commanded_deg(dwell_windows, n, rng.uniform(0.0, 1.0))
    linear = first_order(0.0035, 0.0015 + late_s, WINDOW_S / FINE)
    speed = free_run(linear, CURVE.speed_rad_s(phase_deg)).reshape(n, FINE).mean(axis=1)
    noisy = speed + 0.0135 * rng.standard_normal(n)
    t_s, window_s = WINDOW_S * np.arange(1.0, n + 1.0), np.full(n, WINDOW_S)
    return Record(f"run {seed}", t_s, phase_deg[FINE - 1 :: FINE], noisy, window_s)


@cache
def known_dwelling() -> HammersteinModel:
    """Return the model that one such run gives."""
    run = dwelling_run(1)
    return with_knowledge(identify_fast([run], FastOptions()).model, [run])
