"""Runs over plans of several kinds, and the shape of curve that they settle on."""

import numpy as np
from numpy.typing import NDArray

from benchmarks.plain_motor import Wrong, motor_of, speed_rad_s
from benchmarks.plain_runs import plan_deg
from usmbench.identify.gather import from_windows
from usmbench.identify.shape import FastOptions, Shape, rough_fit, settle_shape
from usmbench.runs.record import Record


def shaped_run(
    kind: str,
    n: int,
    window_s: float,
    seed: int = 9,
    given_deg: NDArray[np.float64] | None = None,
) -> Record:
    rng = np.random.default_rng(seed)
    motor = motor_of(rng)
    phase_deg = plan_deg(kind, n, 90.0, rng) if given_deg is None else given_deg
    speed, _ = speed_rad_s(motor, phase_deg, window_s, Wrong(), rng)
    noisy = speed + 0.02 * rng.standard_normal(n)
    return Record(kind, window_s * np.arange(1.0, n + 1.0), phase_deg, noisy, np.full(n, window_s))


def shape_of(*runs: Record) -> Shape:
    data, options = from_windows(runs), FastOptions()
    return settle_shape(data, rough_fit(data, data, options), options)
