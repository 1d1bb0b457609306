"""An interval follows the valley in which several values lie."""

import numpy as np
import pytest

from known_motor import applied, measured, problem_of
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.intervals import intervals
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

WINDOW_S, NOISE_RAD_S, N = 0.01, 0.03, 2000
CURVE = StaticCurve(np.array([-90.0, -8, 8, 90]), np.array([-10.0, 0, 0, 10.0]))


def test_a_warm_up_far_beyond_the_run_leaves_its_end_open_and_its_slope_known() -> None:
    """A straight line in time is d t/τ: any d will do with a τ in the same ratio."""
    point = OperatingPoint(None, None, CURVE, (-90.0, 90.0), (-15.0, 15.0), NOISE_RAD_S)
    model = HammersteinModel(first_order(0.0035, 0.0, WINDOW_S), (point,), "fast")
    draw = np.random.default_rng(3)
    phase_deg = np.repeat(draw.uniform(-80.0, 80.0, N // 5), 5)
    t_s = WINDOW_S * np.arange(1.0, N + 1.0)
    context = Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, model.linear)
    hidden = Applied(
        find_effect("thermal_drift", "speed"), {"final_drift": 0.2, "warm_up_s": 400.0}
    )
    speed_rad_s = extended_run([hidden], context).speed_rad_s
    speed_rad_s += NOISE_RAD_S * draw.standard_normal(N)
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(N, WINDOW_S))
    stretches, _ = cut_runs([record], model, ())
    known = knowledge_of(model)
    rows = [s.use for s in stretches]
    noise = estimate_noise(stretches, [s.residual_rad_s for s in stretches], rows)
    problem = Problem(stretches, known, noise, rows)
    fit = refine(problem, Fit((hidden,), 0.0, 0.0))
    (found,) = intervals(problem, fit, 1.0)
    (low, high), (soon_s, late_s) = found["final_drift"], found["warm_up_s"]
    assert soon_s < 400.0 < late_s
    assert low < 0.2 < high
    # Both ends of one belong to those of the other.
    assert 0.0 < low < 2.0 * soon_s * 0.2 / 400.0
    assert high > 0.5 * late_s * 0.2 / 400.0


@pytest.mark.parametrize("effect", ["gain_asymmetry", "transport_delay"])
def test_a_noise_that_has_grown_widens_it_by_as_much(effect: str) -> None:
    hidden = {
        "gain_asymmetry": applied("gain_asymmetry", "balanced", asymmetry=0.03),
        "transport_delay": applied("transport_delay", "", delay_s=0.003),
    }[effect]
    problem = problem_of([measured(5, hidden)])
    fit = refine(problem, Fit((hidden,), 0.0, 0.0))
    widths = []
    for spread in (1.0, 1.5):
        ((low, high),) = intervals(problem, fit, spread)[0].values()
        widths.append(high - low)
    assert widths[1] / widths[0] == pytest.approx(1.5, rel=0.05)
