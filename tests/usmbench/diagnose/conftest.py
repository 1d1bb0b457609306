"""A short run of a plain motor, cut into stretches."""

import numpy as np
import pytest

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record


@pytest.fixture
def model() -> HammersteinModel:
    """Return the motor."""
    curve = StaticCurve(
        np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90]),
        np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4]),
    )
    point = OperatingPoint(None, None, curve, (-90.0, 90.0), (-15.0, 15.0), 0.02)
    return HammersteinModel(first_order(0.0035, 0.0015, 0.01), (point,), "fast")


@pytest.fixture
def stretches(model: HammersteinModel) -> list[Stretch]:
    """Return one run of 200 windows, of a motor without a lag."""
    phase_deg = np.repeat(np.random.default_rng(0).uniform(-88.0, 88.0, 40), 5)
    t_s = 0.01 * np.arange(1.0, phase_deg.size + 1.0)
    speed_rad_s = model.points[0].curve.speed_rad_s(phase_deg)
    return cut_runs([Record("run", t_s, phase_deg, speed_rad_s, np.full(200, 0.01))], model, ())[0]
