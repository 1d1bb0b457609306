"""Rivals of two causes weighed once more, in the motor that shows both."""

from dataclasses import replace

import pytest

from known_motor import applied, identified, measured
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.ranking import Ranked, alternatives
from usmbench.diagnose.naming.stepwise import Named
from usmbench.diagnose.naming.weighed_again import weighed_again
from usmbench.diagnose.pipeline import searched
from usmbench.diagnose.residual.own_effects import cut_beside_own
from usmbench.model.applied import Applied

DELAY = applied("transport_delay", "", delay_s=0.0137)
SCALE = applied("speed_scale", "", scale_error=-0.15)
LAG = applied("slow_dynamics", "", added_s=0.01)
CRYSTAL = applied("crystal_error", "", speed_lost=0.15, held_back_rad_s=0.0)


@pytest.fixture(scope="module")
def found() -> Found:
    stretches, _ = cut_beside_own([measured(300, DELAY, SCALE)], identified())
    return searched(stretches, identified())


def ranked(found: Found, other: Applied, last: Applied, score: float) -> Ranked:
    """Return a cause beside another, said to be worth so much."""
    fit = refine(found.problem, Fit((other, last), found.problem.drop((other, last)), 0.0))
    return Ranked(last.effect, fit, score + 8.0, 0.0, score)


def test_what_looks_the_same_comes_after_what_costs_less(found: Found) -> None:
    """Though in a motor that does not show the scale it was worth a third more."""
    delay = ranked(found, SCALE, DELAY, 1e6)
    crystal, scale = ranked(found, DELAY, CRYSTAL, 8e4), ranked(found, DELAY, SCALE, 6e4)
    crystal = replace(crystal, statistic=8e4 + 16.0)
    named = Named(found.problem, [[delay], [crystal, scale]], crystal.fit, 1.0)
    again = weighed_again(named)
    assert [ranking[0].effect.name for ranking in again.rankings] == [
        "transport_delay",
        "speed_scale",
    ]
    assert alternatives(again.rankings[1]) == ("crystal_error",)
    assert {a.effect.name for a in again.fit.effects} == {"transport_delay", "speed_scale"}
    assert again.fit.statistic == pytest.approx(crystal.fit.statistic, abs=10.0)


def test_one_name_is_left_as_it_is(found: Found) -> None:
    named = Named(found.problem, [[ranked(found, SCALE, DELAY, 1e6)]], found.fit, 1.0)
    assert weighed_again(named) is named


def test_what_was_weighed_where_chance_does_not_strike_is_left_as_it_is(found: Found) -> None:
    lost = applied("missed_counts", "of the excess", lost_of_excess=0.5, above_rad_s=9.0)
    counts, scale = ranked(found, SCALE, lost, 1e6), ranked(found, lost, SCALE, 6e4)
    crystal = replace(ranked(found, lost, CRYSTAL, 8e4), statistic=8e4 + 16.0)
    named = Named(found.problem, [[counts], [scale, crystal]], scale.fit, 1.0)
    assert weighed_again(named) is named


def test_what_was_ahead_and_did_not_hold_takes_no_place(found: Found) -> None:
    delay, scale = ranked(found, SCALE, DELAY, 100.0), ranked(found, DELAY, SCALE, 6e4)
    alone = Fit((LAG,), found.problem.drop((LAG,)), 0.0)
    ahead = Ranked(LAG.effect, alone, 1e9, 0.0, 1e9)
    again = weighed_again(Named(found.problem, [[delay, ahead], [scale]], scale.fit, 1.0))
    assert [ranking[0].effect.name for ranking in again.rankings] == [
        "transport_delay",
        "speed_scale",
    ]
    assert {a.effect.name for a in again.fit.effects} == {"transport_delay", "speed_scale"}
    assert again.rankings[0][1] is ahead


def test_a_rival_is_as_sure_as_what_it_brings_beside_the_others(found: Found) -> None:
    """Before, where nothing showed the others, it was no more than chance."""
    delay, scale = ranked(found, SCALE, DELAY, 1e6), ranked(found, DELAY, SCALE, 6e4)
    crystal = replace(ranked(found, DELAY, CRYSTAL, 1.0), statistic=17.0, p_value=1.0)
    again = weighed_again(Named(found.problem, [[delay], [scale, crystal]], scale.fit, 1.0))
    assert [r.effect.name for r in again.rankings[1]] == ["speed_scale", "crystal_error"]
    assert again.rankings[1][1].p_value < 1e-9


@pytest.mark.parametrize("without", [0.0, 490.0])
def test_what_others_do_better_beside_a_rival_and_without_it_is_not_its_doing(
    found: Found, monkeypatch: pytest.MonkeyPatch, without: float
) -> None:
    delay, scale = ranked(found, SCALE, DELAY, 1e6), ranked(found, DELAY, SCALE, 6e4)
    crystal = replace(ranked(found, DELAY, CRYSTAL, 1.0), statistic=9.0)
    both = scale.fit.statistic

    def refined(_: object, fit: Fit) -> Fit:
        """Fit better by 500 beside the crystal, and by all but 10 of it or of all without."""
        alone = len(fit.effects) == 1
        return replace(fit, statistic=(both + 490.0 if without else 0.0) if alone else both + 500.0)

    monkeypatch.setattr("usmbench.diagnose.naming.weighed_again.refine", refined)
    again = weighed_again(Named(found.problem, [[delay], [scale, crystal]], scale.fit, 1.0))
    names = [ranking[0].effect.name for ranking in again.rankings]
    assert names == ["transport_delay", "speed_scale" if without else "crystal_error"]
