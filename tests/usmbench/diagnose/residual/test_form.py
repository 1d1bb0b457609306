"""What a large effect leaves of itself is no news, and what acts where it does not is."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from known_motor import applied
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.residual.form import off_in_form
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.base import DEFINITION, PHYSICS
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import extended_run
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


def _beginning_at(edge_deg: float, stretch: Stretch) -> Stretch:
    """Return a stretch whose motor turns from a phase on, gently."""

    def settled_rad_s(phase_deg: Array) -> Array:
        beyond_deg = np.maximum(np.abs(phase_deg) - edge_deg, 0.0)
        return np.asarray(np.sign(phase_deg) * 10.0 * (1.0 - np.exp(-((beyond_deg / 20.0) ** 2))))

    phase_deg = np.concatenate([np.linspace(-15.0, 15.0, 100), np.linspace(15.0, -15.0, 100)])
    context = replace(stretch.context, settled_rad_s=settled_rad_s, phase_deg=phase_deg)
    return replace(stretch, context=context, simulated_rad_s=extended_run([], context).speed_rad_s)


@pytest.mark.parametrize("farther", [-0.03, 0.02])
def test_what_begins_at_an_edge_of_the_dead_zone_begins_elsewhere_where_edges_wander(
    stretches: list[Stretch], model: HammersteinModel, farther: float
) -> None:
    weight = [applied("load_torque", "weight", one_sided_rad_s=-0.5)]
    here, there = (_beginning_at(edge, stretches[0]) for edge in (8.0, 8.0 * (1.0 + farther)))
    noise = estimate_noise([here], [np.tile([0.01, -0.01], 100)], [here.use])
    known = knowledge_of(model)

    def changes(stretch: Stretch) -> Array:
        return extended_run(weight, stretch.context).speed_rad_s - stretch.simulated_rad_s

    def doubted(wander: float) -> float:
        wandering = replace(known, wander=replace(known.wander, wider=wander, one_sided=0.0))
        problem = Problem([here], wandering, noise, [here.use]).doubting(weight)
        return problem.square([changes(there) - changes(here)])

    assert doubted(0.03) < 0.2 * doubted(0.001)
