"""Rivals of two causes weighed once more, in the motor that shows both."""

from dataclasses import replace

import pytest

from known_motor import applied, measured, problem_of
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.naming.ranking import Ranked, alternatives
from usmbench.diagnose.naming.stepwise import Named
from usmbench.diagnose.naming.weighed_again import weighed_again
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied

DELAY = applied("transport_delay", "", delay_s=0.0137)
SCALE = applied("speed_scale", "", scale_error=-0.15)
LAG = applied("slow_dynamics", "", added_s=0.01)
CRYSTAL = applied("crystal_error", "", speed_lost=0.15, held_back_rad_s=0.0)


@pytest.fixture(scope="module")
def problem() -> Problem:
    """Return a run of a motor that shows both, as a search leaves it."""
    return problem_of([measured(300, DELAY, SCALE)]).showing((DELAY, SCALE))


def ranked(problem: Problem, other: Applied, last: Applied, score: float) -> Ranked:
    """Return a cause beside another, said to be worth so much."""
    fit = refine(problem, Fit((other, last), problem.drop((other, last)), 0.0))
    return Ranked(last.effect, fit, score + 8.0, 0.0, score)


def test_what_looks_the_same_comes_after_what_costs_less(problem: Problem) -> None:
    """Though in a motor that does not show the scale it was worth a third more."""
    delay = ranked(problem, SCALE, DELAY, 1e6)
    crystal, scale = ranked(problem, DELAY, CRYSTAL, 8e4), ranked(problem, DELAY, SCALE, 6e4)
    crystal = replace(crystal, statistic=8e4 + 16.0)
    named = Named(problem, [[delay], [crystal, scale]], crystal.fit, 1.0)
    again = weighed_again(named)
    assert [ranking[0].effect.name for ranking in again.rankings] == [
        "transport_delay",
        "speed_scale",
    ]
    assert alternatives(again.rankings[1]) == ("crystal_error",)
    assert {a.effect.name for a in again.fit.effects} == {"transport_delay", "speed_scale"}
    assert again.fit.statistic == pytest.approx(crystal.fit.statistic, abs=10.0)


def test_one_name_is_left_as_it_is(problem: Problem) -> None:
    delay = ranked(problem, SCALE, DELAY, 1e6)
    named = Named(problem, [[delay]], delay.fit, 1.0)
    assert weighed_again(named) is named


def test_what_was_weighed_where_chance_does_not_strike_is_left_as_it_is(problem: Problem) -> None:
    lost = applied("missed_counts", "of the excess", lost_of_excess=0.5, above_rad_s=9.0)
    counts, scale = ranked(problem, SCALE, lost, 1e6), ranked(problem, lost, SCALE, 6e4)
    crystal = replace(ranked(problem, lost, CRYSTAL, 8e4), statistic=8e4 + 16.0)
    named = Named(problem, [[counts], [scale, crystal]], scale.fit, 1.0)
    assert weighed_again(named) is named


def test_what_was_ahead_and_did_not_hold_takes_no_place(problem: Problem) -> None:
    delay, scale = ranked(problem, SCALE, DELAY, 100.0), ranked(problem, DELAY, SCALE, 6e4)
    alone = Fit((LAG,), problem.drop((LAG,)), 0.0)
    ahead = Ranked(LAG.effect, alone, 1e9, 0.0, 1e9)
    again = weighed_again(Named(problem, [[delay, ahead], [scale]], scale.fit, 1.0))
    assert [ranking[0].effect.name for ranking in again.rankings] == [
        "transport_delay",
        "speed_scale",
    ]
    assert {a.effect.name for a in again.fit.effects} == {"transport_delay", "speed_scale"}
    assert again.rankings[0][1] is ahead


def test_a_rival_is_as_sure_as_what_it_brings_beside_the_others(problem: Problem) -> None:
    """Before, where nothing showed the others, it was no more than chance."""
    delay, scale = ranked(problem, SCALE, DELAY, 1e6), ranked(problem, DELAY, SCALE, 6e4)
    crystal = replace(ranked(problem, DELAY, CRYSTAL, 1.0), statistic=17.0, p_value=1.0)
    again = weighed_again(Named(problem, [[delay], [scale, crystal]], scale.fit, 1.0))
    assert [r.effect.name for r in again.rankings[1]] == ["speed_scale", "crystal_error"]
    assert again.rankings[1][1].p_value < 1e-9


@pytest.mark.parametrize("without", [0.0, 490.0])
def test_what_others_do_better_beside_a_rival_and_without_it_is_not_its_doing(
    problem: Problem, monkeypatch: pytest.MonkeyPatch, without: float
) -> None:
    delay, scale = ranked(problem, SCALE, DELAY, 1e6), ranked(problem, DELAY, SCALE, 6e4)
    crystal = replace(ranked(problem, DELAY, CRYSTAL, 1.0), statistic=9.0)
    both = scale.fit.statistic

    def refined(_: object, fit: Fit) -> Fit:
        """Fit better by 500 beside the crystal, and by all but 10 of it or of all without."""
        alone = len(fit.effects) == 1
        return replace(fit, statistic=(both + 490.0 if without else 0.0) if alone else both + 500.0)

    monkeypatch.setattr("usmbench.diagnose.naming.weighed_again.refine", refined)
    again = weighed_again(Named(problem, [[delay], [scale, crystal]], scale.fit, 1.0))
    names = [ranking[0].effect.name for ranking in again.rankings]
    assert names == ["transport_delay", "speed_scale" if without else "crystal_error"]
