"""What stands of what a search came to."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, applied, driven, identified
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.held import held
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.pipeline import searched
from usmbench.diagnose.residual.own_effects import cut_beside_own


@pytest.mark.parametrize("false_counts", [True, False])
def test_names_that_do_not_stand_say_nothing_against_false_counts(false_counts: bool) -> None:
    phase_deg = np.repeat(np.random.default_rng(2).uniform(30.0, 88.0, 100), 20)
    record = driven(phase_deg, 4)
    off = np.zeros(phase_deg.size)
    off[210::200] = 25.0 * NOISE_RAD_S * false_counts
    record = replace(record, speed_rad_s=record.speed_rad_s + off)
    found = searched(cut_beside_own([record], identified())[0], identified())
    assert not found.named
    nothing = Fit((applied("phase_offset", "", offset_deg=1e-4),), 0.0, 0.0)
    three = replace(found, named=[found.ranked] * 3, fit=nothing)  # more than may be named
    stands = held(three)
    names = [cause.named.name for cause in stands.sporadic]
    assert not stands.found.named
    assert (stands.verdict, names) == (
        ("explained", ["count_glitches"]) if false_counts else ("unexplained", [])
    )


@pytest.mark.parametrize("first", ["explained", "unexplained"])
def test_what_chance_strikes_stands_by_all_its_windows_too(
    first: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The search keeps those far out from its fits, which then leave a part of the mean."""
    phase_deg = np.repeat(np.random.default_rng(2).uniform(30.0, 88.0, 100), 20)
    found = searched(cut_beside_own([driven(phase_deg, 4)], identified())[0], identified())
    struck = replace(found, spread=1.5)
    second = "explained" if first == "unexplained" else "unexplained"
    monkeypatch.setattr(Found, "count_scatter", lambda _: struck)
    monkeypatch.setattr(
        "usmbench.diagnose.held.verdict_on", lambda f, _: second if f is struck else first
    )
    stands = held(found)
    assert (stands.verdict, stands.found) == ("explained", struck)
