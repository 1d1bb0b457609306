"""Which causes explain about as much, and when so many do that a name tells nothing."""

import pytest

from usmbench.diagnose.fitting.fit import NOTHING
from usmbench.diagnose.naming.ranking import Ranked, alternatives, undecided
from usmbench.model.effects.registry import library


@pytest.mark.parametrize(
    ("leads_by", "p_value", "tells"), [(0.0, 4e-3, False), (20.0, 4e-3, True), (0.0, 1e-9, True)]
)
def test_a_cause_that_any_other_may_stand_for_is_none_but_beyond_chance(
    leads_by: float, p_value: float, tells: bool
) -> None:
    causes = {effect.name: effect for effect in library()}
    scores = [15.0 + leads_by * (k == 0) for k in range(len(causes))]
    ranked = [
        Ranked(effect, NOTHING, score, p_value, score)
        for effect, score in zip(causes.values(), scores, strict=True)
    ]
    assert undecided(ranked) != tells


def test_what_explains_no_more_than_chance_is_no_alternative() -> None:
    causes = {effect.name: effect for effect in library()}
    first, second, third = list(causes.values())[:3]
    ranked = [
        Ranked(effect, NOTHING, statistic, p_value, statistic - 7.6)
        for effect, statistic, p_value in (
            (first, 13.0, 0.01),
            (second, 8.0, 0.15),
            (third, 0.3, 1.0),
        )
    ]
    assert alternatives(ranked) == (second.name,)
