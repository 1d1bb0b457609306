"""Which causes are named, one after the other."""

from dataclasses import replace

import pytest

import known_motor
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.ranking import rank
from usmbench.diagnose.naming.stepwise import Named, name_causes
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.effects.registry import find_effect


@pytest.mark.parametrize(("share_lost", "above_rad_s"), [(0.002, 5.0), (0.003, 3.0)])
def test_what_one_that_acts_by_chance_leaves_below_the_noise_is_no_second_cause(
    share_lost: float, above_rad_s: float
) -> None:
    """A counter loses less than the noise of most windows, which is plain in all together."""
    model, sizes = known_motor.identified(), {"share_lost": share_lost, "above_rad_s": above_rad_s}
    lost = known_motor.applied("missed_counts", "of all", **sizes)
    (stretch,), _ = cut_runs([known_motor.measured(7, lost, n=6000)], model, ())
    known = replace(knowledge_of(model), root=0.01 * knowledge_of(model).root)
    assert known.noise is not None
    problem = Problem([stretch], known, known.noise, [stretch.use])
    effects = [lost.effect, find_effect("amplitude_droop", "at once")]
    ranked = rank(problem, effects, 1.0)
    found = name_causes(problem, ranked, effects, 1.0)
    assert _names(found) == ["missed_counts"]


def _names(found: Named) -> list[str]:
    return [ranking[0].effect.name for ranking in found.rankings]
