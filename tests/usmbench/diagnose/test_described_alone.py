"""Single-window causes through a whole diagnosis: left out, told beside others, known before."""

from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, WINDOW_S, applied, identified
from tests.usmbench.diagnose.gapped_runs import found_in, gapped_run, with_false_counts
from usmbench.diagnose.described_alone import lone_views, named_alone
from usmbench.diagnose.extended_effects import extended_effects
from usmbench.diagnose.fitting.fit import NOTHING
from usmbench.diagnose.held import Held
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.sporadic import Sporadic
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.effects.damaged_disc import DamagedDisc
from usmbench.model.effects.lone_windows import SporadicEffect

OFF_RAD_S, EVERY = 40.0 * NOISE_RAD_S, 100


def test_false_counts_beside_a_gap_of_the_disc_are_named_beside_it() -> None:
    record = with_false_counts(gapped_run(12, (2.0, 0.05)), OFF_RAD_S, EVERY)
    found = diagnose([record], identified())
    assert found.verdict == "explained"
    assert sorted(cause.name for cause in found.causes) == ["count_glitches", "damaged_disc"]
    assert not found.foretells
    rates = {c.name: {p.name: p for p in c.parameters}["rate_hz"] for c in found.causes}
    rate_hz = rates["count_glitches"]
    assert rate_hz.low < 1.0 / (EVERY * WINDOW_S) < rate_hz.high
    said = " ".join(found.warnings)
    assert "windows that damaged_disc may have struck are left out" in said
    assert "which windows count_glitches strikes" in said
    assert [view.cause for view in found.lone_views] == ["damaged_disc", "count_glitches"]
    assert np.all(found.lone_views[0].off_rad_s != 0.0)
    assert [e["name"] for e in found.extended.effects] == ["damaged_disc", "count_glitches"]


def test_a_cause_that_leaves_nothing_out_ends_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """As a user's own may."""
    monkeypatch.setattr(DamagedDisc, "touched", SporadicEffect.touched)
    found = diagnose([gapped_run(12, (2.0, 0.05))], identified())
    assert [cause.name for cause in found.causes] == ["damaged_disc"]


def held_by(*sporadic: Sporadic, verdict: str = "explained") -> Held:
    nothing = Mock(spec=Found, fit=NOTHING)
    held: Held = Mock(spec=Held, sporadic=sporadic, verdict=verdict, found=nothing)
    return held


@pytest.fixture(scope="module")
def gaps() -> tuple[Sporadic, Sporadic]:
    """Return the same gap found in two runs."""
    return found_in(gapped_run(12, (2.0, 0.05))), found_in(gapped_run(13, (1.0, 0.05)))


def test_of_two_places_one_name_is_told_and_both_are_simulated(
    gaps: tuple[Sporadic, Sporadic],
) -> None:
    held = held_by(*gaps)
    (named,) = named_alone(held)
    assert named is gaps[0].named
    assert len(lone_views(held)) == 2
    entries = extended_effects(held, identified())
    assert list(entries) == [gap.applied.to_mapping() for gap in gaps]


def test_what_is_no_news_stays_in_the_model_unless_more_of_it_is_found(
    gaps: tuple[Sporadic, Sporadic],
) -> None:
    known, found = replace(gaps[0], is_news=False), gaps[1]
    other = applied("count_glitches", "", rate_hz=1.0, size_rad_s=3.0).to_mapping()
    has = replace(identified(), effects=(gaps[0].applied.to_mapping(), other))
    assert named_alone(held_by(known)) == []
    assert extended_effects(held_by(known), has) == has.effects
    both = held_by(known, found)
    assert named_alone(both) == [found.named]
    assert list(extended_effects(both, has)) == [
        other,
        known.applied.to_mapping(),
        found.applied.to_mapping(),
    ]


@pytest.mark.parametrize("verdict", ["unexplained", "no_discrepancy"])
def test_a_name_that_does_not_stand_is_not_told(
    gaps: tuple[Sporadic, Sporadic], verdict: str
) -> None:
    held = held_by(*gaps, verdict=verdict)
    assert named_alone(held) == []
    assert lone_views(held) == ()
    assert extended_effects(held, identified()) == identified().effects
