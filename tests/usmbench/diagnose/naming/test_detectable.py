"""The smallest size that runs would show is one that is found nine times in ten."""

import numpy as np
import pytest
from scipy.stats import norm

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.detectable import smallest_sizes
from usmbench.diagnose.naming.ranking import Ranked
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import find_effect
from usmbench.model.hammerstein import HammersteinModel


def _problem(stretches: list[Stretch], model: HammersteinModel) -> Problem:
    uses = [s.use for s in stretches]
    white = [0.01 * np.random.default_rng(1).standard_normal(s.context.n) for s in stretches]
    return Problem(stretches, knowledge_of(model), estimate_noise(stretches, white, uses), uses)


@pytest.mark.parametrize(
    ("name", "form", "roughness"),
    [("phase_offset", "", 0.0), ("stick_slip", "", 0.0), ("stick_slip", "", 20.0)],
    ids=["either way", "one way", "of a scan"],
)
def test_nine_in_ten_of_the_smallest_size_are_below_the_level_of_a_name(
    stretches: list[Stretch], model: HammersteinModel, name: str, form: str, roughness: float
) -> None:
    problem = _problem(stretches, model)
    effect = find_effect(name, form)
    scanned_as = Ranked(effect, Fit((), 0.0, roughness), 0.0, 1.0, 0.0)
    (smallest,) = smallest_sizes(problem, [effect] * 5, 1.0, [scanned_as])
    scanned = {
        n: float(np.median(g)) for n, g in effect.grid([s.context for s in stretches]).items()
    }
    applied = Applied(effect, {**scanned, smallest.parameter: smallest.value})
    carried = problem.carried(problem.change_rad_s([applied]))
    # A deviation shorter one time in ten.
    shorter = float(np.linalg.norm(carried) - norm.ppf(0.9))
    assert 5 * Fit((applied,), shorter**2, roughness).p_value == pytest.approx(0.05, rel=0.1)


def test_states_what_the_form_needs_that_shows_least(
    stretches: list[Stretch], model: HammersteinModel
) -> None:
    problem = _problem(stretches, model)
    forms = [find_effect("load_torque", f) for f in ("weight", "drag", "drag, wider dead zone")]
    alone = [smallest_sizes(problem, [f] * 3, 1.0)[0] for f in forms]
    assert [d.unit for d in alone] == ["rad/s", "rad/s", "deg"]
    # One in another unit has no part in it.
    most = max(alone[:2], key=lambda d: d.value)
    assert alone[0].value != pytest.approx(alone[1].value, rel=0.2)
    assert smallest_sizes(problem, forms, 1.0) == (most,)
    assert smallest_sizes(problem, [forms[1], forms[0], forms[2]], 1.0) == (most,)


def test_a_ringing_shorter_than_windows_show_is_not_said_to_show(
    stretches: list[Stretch], model: HammersteinModel
) -> None:
    ringing = find_effect("shaft_compliance", "")
    (smallest,) = smallest_sizes(_problem(stretches, model), [ringing] * 5, 1.0)
    assert smallest.value >= 2.0 * stretches[0].context.window_s
