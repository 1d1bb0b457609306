"""Which causes explain about as much, and when so many do that a name tells nothing."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import sawtooth

from known_motor import UP_AND_DOWN_DEG, applied, driven, problem_of
from usmbench.diagnose.fitting.fit import NOTHING
from usmbench.diagnose.naming.ranking import Ranked, alternatives, begun_with, rank, undecided
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.effects.registry import find_effect, library
from usmbench.model.effects.sticking import Sticking


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


def test_a_ranking_begins_with_a_form_that_is_as_good_as_the_best_of_its_cause() -> None:
    forms = [e for e in library() if e.name == "load_torque"][:2]
    other = find_effect("speed_scale", "")
    ranked = [
        Ranked(effect, NOTHING, score, 1e-9, score)
        for effect, score in ((forms[0], 90.0), (forms[1], 89.8), (other, 89.8))
    ]
    assert begun_with(ranked, forms[1]) == [ranked[1], ranked[0], ranked[2]]
    assert begun_with(ranked, other) is None
    worse = [ranked[0], Ranked(forms[1], NOTHING, 80.0, 1e-9, 80.0), ranked[2]]
    assert begun_with(worse, forms[1]) is None


STICKS = applied("dead_zone_hysteresis", "sticking", start_later_deg=4.0)
SLIPS = applied("stick_slip", "", lost_rad_s=0.5, fades_rad_s=1.0)
WIDER = Applied(Sticking().lookalikes[0], {"start_later_deg": 4.0})
FROM_REST_DEG = np.ravel([(0.0, phase_deg) for phase_deg in np.arange(-84.0, 85.0, 3.0)])


@pytest.mark.parametrize(
    ("hidden", "weighed", "phase_deg", "is_a_cause"),
    [
        (STICKS, STICKS.effect, UP_AND_DOWN_DEG, True),
        (WIDER, STICKS.effect, FROM_REST_DEG, False),
        (SLIPS, SLIPS.effect, FROM_REST_DEG, True),
        (WIDER, SLIPS.effect, FROM_REST_DEG, False),
    ],
    ids=["sticks", "is off at its edges", "sticks and slips", "is off, and does not slip"],
)
def test_a_cause_yields_to_what_a_model_may_be_off_by(
    hidden: Applied, weighed: Effect, phase_deg: NDArray[np.float64], *, is_a_cause: bool
) -> None:
    problem = problem_of([driven(np.repeat(phase_deg, 10), 3, hidden)])
    (found,) = rank(problem, [weighed], 1.0)
    assert found.fit.statistic > 100.0
    assert (found.p_value < 1e-6) == is_a_cause
    assert (found.score > 0.0) == is_a_cause
    assert (found.misfit == 0.0) == is_a_cause


@pytest.mark.parametrize("seed", range(3))
def test_one_of_many_grids_is_paid_for_with_the_search(seed: int) -> None:
    triangle_deg = 85.0 * sawtooth(0.1 * np.arange(200.0), 0.5)
    problem = problem_of([driven(triangle_deg, seed)])
    grid, scale = find_effect("phase_quantisation", "rounded"), find_effect("speed_scale", "")
    prices = {r.effect: r.statistic - r.score for r in rank(problem, [grid, scale], 1.0)}
    assert prices[scale] == pytest.approx(np.log(problem.n_rows))
    assert prices[grid] > 1.5 * prices[scale]
