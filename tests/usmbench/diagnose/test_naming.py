"""What is left beside a name takes it away only where it is a finding of its own."""

from collections.abc import Sequence

import pytest

from usmbench.diagnose.knowledge import knowledge_of
from usmbench.diagnose.naming import Whole, rank, verdict
from usmbench.diagnose.noise_estimate import estimate_noise
from usmbench.diagnose.problem import Problem
from usmbench.diagnose.result import Verdict
from usmbench.diagnose.stretches import Mask, Stretch
from usmbench.model.effects.base import Effect
from usmbench.model.effects.speed_scale import SpeedScale
from usmbench.model.hammerstein import HammersteinModel

N_ROWS = 1000


@pytest.mark.parametrize(
    ("excess", "p_value", "says"),
    [
        (50.0, 0.01, "explained"),
        (5.0, 1e-6, "explained"),
        (90.0, 1e-6, "partly_explained"),
        (150.0, 1e-6, "unexplained"),
    ],
    ids=["chance", "a small share", "a trifle", "a finding"],
)
def test_a_name_stands_beside_a_trifle(excess: float, p_value: float, says: Verdict) -> None:
    before, after = Whole(200.0, 0.0, N_ROWS), Whole(excess, p_value, N_ROWS)
    assert verdict(before, after, 40.0) == says


@pytest.mark.parametrize("forms", [("", "again"), ("again", "")])
def test_a_cause_gains_nothing_by_being_looked_for_twice(
    stretches: list[Stretch], model: HammersteinModel, forms: Sequence[str]
) -> None:
    effects = [_twin("twofold", form) for form in forms] + [_twin("plain", "")]
    noise = estimate_noise(stretches, [s.residual_rad_s for s in stretches], _uses(stretches))
    problem = Problem(stretches, knowledge_of(model), noise, _uses(stretches))
    ranked = rank(problem, effects, 1.0)
    assert [r.effect.name for r in ranked] == ["plain", "twofold", "twofold"]
    assert ranked[0].statistic == pytest.approx(ranked[1].statistic)


def _twin(name: str, form: str) -> Effect:
    """Return the same cause under another name."""
    twin: Effect = type("Twin", (SpeedScale,), {"name": name, "form": form})()
    return twin


def _uses(stretches: list[Stretch]) -> list[Mask]:
    return [s.use for s in stretches]
