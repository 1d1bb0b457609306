"""A motor whose rotor follows the crests but for a slip, driven on days that differ."""

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Array = NDArray[np.float64]

WINDOW_S, NOISE_RAD_S = 0.01, 0.008
SLIP_RAD_S = {40_050.0: 0.1, 41_000.0: 1.0}  # that friction takes near standstill
DRAGGING_HZ = 41_000.0  # where friction differs from day to day
LINEAR = first_order(0.0035, 0.0015, WINDOW_S)


def settled_rad_s(
    phase_deg: Array, frequency_hz: float, gain: float = 1.0, friction: float = 1.0
) -> Array:
    """Return the settled speed of a rotor that follows the crests but for a slip."""
    shares = np.sin(np.radians(phase_deg))
    slip_rad_s = friction * SLIP_RAD_S[frequency_hz] * (1.0 - shares**2)
    speed: Array = np.maximum(11.0 * gain * np.abs(shares) - slip_rad_s, 0.0) * np.sign(shares)
    return speed


def driven(
    seed: int,
    gain: float,
    friction: float,
    *,
    late_s: float = 0.0,
    tilt: float = 0.0,
    warms: float = 0.0,
    n: int = 2000,
) -> Record:
    """Return a run on a day of its own, half of it at each frequency, in an order that turns."""
    rng = np.random.default_rng(seed)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, n // 10), 10)
    frequency_hz = np.repeat(sorted(SLIP_RAD_S, reverse=bool(seed % 2)), n // 2)
    settled = np.zeros(n)
    for f, side in zip(SLIP_RAD_S, (-1.0, 1.0), strict=True):
        at = frequency_hz == f
        own = friction if f == DRAGGING_HZ else 1.0
        settled[at] = settled_rad_s(phase_deg[at], f, gain + side * tilt, own)
    settled *= 1.0 + warms * np.expm1(-np.arange(n) * WINDOW_S / 10.0)
    linear = first_order(0.0035, 0.0015 + late_s, WINDOW_S)
    speed = free_run(linear, settled) + NOISE_RAD_S * rng.standard_normal(n)
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    window_s, torque_nm = np.full(n, WINDOW_S), np.zeros(n)
    return Record(
        f"run {seed}",
        t_s,
        phase_deg,
        speed,
        window_s,
        frequency_hz=frequency_hz,
        torque_nm=torque_nm,
    )


def slipping_motor() -> HammersteinModel:
    """Return the motor of ordinary days, identified."""
    return identify_fast([driven(k, 1.0, 1.0) for k in range(20, 24)], FastOptions()).model
