"""A fit does not rest where a sample crosses the edge of the dead zone."""

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.joint import Joint
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]

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


def test_a_fit_at_rest_is_left_after_one_step(
    model: HammersteinModel, stretches: list[Stretch], monkeypatch: pytest.MonkeyPatch
) -> None:
    uses = [s.use for s in stretches]
    noise = estimate_noise(stretches, [s.residual_rad_s for s in stretches], uses)
    problem = Problem(stretches, knowledge_of(model), noise, uses)
    start = Fit((Applied(find_effect("speed_scale", ""), {"scale_error": 0.0}),), 0.0, 0.0)
    best = refine(problem, refine(problem, start))
    asked: list[Array] = []

    def counting(joint: Joint, theta: Array) -> float:
        asked.append(theta)
        return deviance(joint, theta)

    deviance = Joint.deviance
    monkeypatch.setattr(Joint, "deviance", counting)
    again = refine(problem, best)
    assert again.statistic == pytest.approx(best.statistic, abs=1e-6)
    assert len(asked) == 2
