"""A motor whose every parameter is known, measured as the bench measures."""

from collections.abc import Callable

import numpy as np
import pytest

from usmbench.identify.lag_family import LagFamily
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

WINDOW_S, TAU_S, DEAD_TIME_S = 0.01, 0.0035, 0.0015
KNOTS_DEG = np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90])
DELTA_RAD_S = np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4])
PARAMETERS = np.array([np.log(TAU_S / WINDOW_S), DEAD_TIME_S / WINDOW_S])


@pytest.fixture
def curve() -> StaticCurve:
    """Return the motor's static curve."""
    return StaticCurve(KNOTS_DEG, DELTA_RAD_S)


@pytest.fixture
def measure(curve: StaticCurve) -> Callable[..., Record]:
    """Return a function that measures the motor over random dwells."""

    def run(
        n: int = 1500,
        *,
        seed: int = 0,
        dwell: int = 5,
        noise_rad_s: float = 0.02,
        gain: float = 1.0,
        point: tuple[float, float] | None = None,
    ) -> Record:
        rng = np.random.default_rng(seed)
        phase_deg = np.repeat(rng.uniform(-90.0, 90.0, n // dwell + 1), dwell)[:n]
        phase_deg[:2] = -90.0
        phase_deg[dwell * (n // (2 * dwell)) :][:2] = 90.0
        linear = LagFamily(1.0).dynamics(PARAMETERS).linear_part(WINDOW_S)
        clean = free_run(linear, gain * curve.speed_rad_s(phase_deg))
        frequency_hz, torque_nm = (None, None) if point is None else (np.full(n, p) for p in point)
        return Record(
            f"run {seed}",
            WINDOW_S * np.arange(1.0, n + 1.0),
            phase_deg,
            clean + noise_rad_s * rng.standard_normal(n),
            np.full(n, WINDOW_S),
            frequency_hz=frequency_hz,
            torque_nm=torque_nm,
        )

    return run
