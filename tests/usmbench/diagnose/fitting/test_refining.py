"""A fit does not rest where a sample crosses the edge of the dead zone."""

import numpy as np
import pytest

from usmbench.diagnose.pipeline import diagnose
from usmbench.model.effects.base import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import Applied, extended_run
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

WINDOW_S, NOISE_RAD_S = 0.01, 0.03
CURVE = StaticCurve(
    np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90]),
    np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4]),
)
GRID_DEG = 2.0


@pytest.mark.parametrize("offset_deg", [-3.1, 2.7])
def test_an_offset_of_more_than_a_step_of_the_grid_is_measured(offset_deg: float) -> None:
    point = OperatingPoint(None, None, CURVE, (-90.0, 90.0), (-15.0, 15.0), NOISE_RAD_S)
    model = HammersteinModel(first_order(0.0035, 0.0, WINDOW_S), (point,), "fast")
    up_deg = np.arange(-80.0, 80.0, GRID_DEG)
    phase_deg = np.repeat(np.r_[up_deg, up_deg[::-1]], 5)
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    context = Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, model.linear)
    hidden = Applied(find_effect("phase_offset", ""), {"offset_deg": offset_deg})
    noise_rad_s = NOISE_RAD_S * np.random.default_rng(4).standard_normal(t_s.size)
    speed_rad_s = extended_run([hidden], context).speed_rad_s + noise_rad_s
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(t_s.size, WINDOW_S))
    (cause,) = diagnose([record], model).causes
    assert cause.name == "phase_offset"
    (found,) = cause.parameters
    assert found.value == pytest.approx(offset_deg, abs=0.2)
