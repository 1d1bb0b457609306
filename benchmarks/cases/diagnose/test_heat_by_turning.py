"""Motors that their own motion warms, and that cool where they rest: no supply that gives way."""

import numpy as np
import pytest
from numpy.typing import NDArray

from known_motor import CURVE, LINEAR, NOISE_RAD_S, WINDOW_S, identified
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

Array = NDArray[np.float64]


_TOP_RAD_S, _WINDOWS = 10.4, 3000


def _rests_and_drives_deg(draw: np.random.Generator) -> Array:
    phase_deg = np.repeat(draw.uniform(-88.0, 88.0, _WINDOWS // 5), 5)
    rests = np.repeat(draw.permutation([1.0, 1.0, 1.0, 0.0, 0.15, 0.0]), _WINDOWS // 6)
    return np.asarray(phase_deg * rests)


def _warming(settled_rad_s: Array, power: float, constant_s: float, lost: float) -> Array:
    """Settled speed of a motor that loses speed by its heat, one window after the other."""
    heat, slower = 0.0, np.empty(settled_rad_s.size)
    for k, speed in enumerate(settled_rad_s):
        slower[k] = speed * (1.0 - lost * heat)
        heat += WINDOW_S / constant_s * ((abs(speed) / _TOP_RAD_S) ** power - heat)
    return slower


@pytest.mark.parametrize("seed", range(2))
def test_heat_that_comes_and_goes_with_the_speed_is_no_droop(seed: int) -> None:
    draw = np.random.default_rng([seed, 113])
    phase_deg = _rests_and_drives_deg(draw)
    healthy = CURVE.speed_rad_s(phase_deg)
    power, constant_s = draw.uniform(0.8, 2.0), draw.uniform(2.5, 6.0)
    wholly = _warming(healthy, power, constant_s, 1.0) - healthy
    lost = draw.uniform(2.0, 4.0) * NOISE_RAD_S / float(np.sqrt(np.mean(wholly**2)))
    noise = NOISE_RAD_S * draw.standard_normal(_WINDOWS)
    speed_rad_s = free_run(LINEAR, _warming(healthy, power, constant_s, lost)) + noise
    t_s = WINDOW_S * np.arange(1.0, _WINDOWS + 1.0)
    record = Record(f"heat {seed}", t_s, phase_deg, speed_rad_s, np.full(_WINDOWS, WINDOW_S))
    found = diagnose([record], identified())
    assert [cause.name for cause in found.causes] == ["thermal_drift"]
    assert found.verdict == "explained"
