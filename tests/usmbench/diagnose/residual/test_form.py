"""What a large effect leaves of itself is no news, and what acts where it does not is."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from known_motor import applied, identified, measured
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.residual.form import off_in_form
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.effects.base import DEFINITION, PHYSICS
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import Applied
from usmbench.model.hammerstein import HammersteinModel

Array = NDArray[np.float64]
LATE = [Applied(find_effect("transport_delay", ""), {"delay_s": 0.004})]


def test_an_effect_is_off_by_a_share_of_itself_at_each_speed_and_time(
    stretches: list[Stretch],
) -> None:
    (stretch,) = stretches
    change = np.where(stretch.lag == 0, 2.0, 0.0)
    off = off_in_form(stretch, change)
    assert not np.any(off[(change == 0.0) & (np.r_[0.0, change[:-1]] == 0.0)])
    assert np.max(np.abs(off)) <= 2.0 * PHYSICS
    np.testing.assert_allclose(off_in_form(stretch, 3.0 * change), 3.0 * off)
    less = off_in_form(stretch, change, DEFINITION)
    np.testing.assert_allclose(less, DEFINITION / PHYSICS * off)


def test_a_doubted_effect_leaves_its_share_and_no_more(
    stretches: list[Stretch], model: HammersteinModel
) -> None:
    uses = [s.use for s in stretches]
    white = [0.01 * np.random.default_rng(1).standard_normal(s.context.n) for s in stretches]
    noise = estimate_noise(stretches, white, uses)
    problem = Problem(stretches, knowledge_of(model), noise, uses)
    doubting = problem.doubting(LATE)

    def deviance(of: Problem, signal: Array) -> float:
        carried = of.carried([signal])
        return float(carried @ carried)

    (change,) = problem.change_rad_s(LATE)
    (stretch,) = stretches
    tenth, elsewhere = 0.1 * change, np.where(stretch.lag == 3, 0.1, 0.0)
    later = 0.1 * np.diff(change, prepend=change[0])
    for known in (tenth, later):
        assert deviance(doubting, known) < 0.05 * deviance(problem, known)
    assert deviance(doubting, elsewhere) > 0.9 * deviance(problem, elsewhere)
    assert deviance(doubting, 10.0 * tenth) > 50.0 * deviance(doubting, tenth)


@pytest.mark.parametrize(("added_s", "named"), [(5.2e-3, []), (9e-3, ["slow_dynamics"])])
def test_an_extended_model_may_be_off_in_form_and_sees_what_has_grown(
    added_s: float, named: list[str]
) -> None:
    lag = applied("slow_dynamics", "", added_s=5e-3)
    extended = replace(identified(), effects=(lag.to_mapping(),))
    record = measured(5, applied("slow_dynamics", "", added_s=added_s))
    assert [cause.name for cause in diagnose([record], extended).causes] == named
