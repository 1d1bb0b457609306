"""What stands of what a search came to."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, applied, driven, identified, measured
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.held import held
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
    names = [] if stands.sporadic is None else [stands.sporadic.named.name]
    assert not stands.found.named
    assert (stands.verdict, names) == (
        ("explained", ["count_glitches"]) if false_counts else ("unexplained", [])
    )


@pytest.mark.parametrize(
    ("gained", "p_value", "stands"), [(0.01, 2e-3, False), (0.01, 5e-4, True), (0.03, 2e-3, True)]
)
def test_a_name_that_gains_next_to_nothing_has_to_be_surer(
    monkeypatch: pytest.MonkeyPatch, gained: float, p_value: float, stands: bool
) -> None:
    record = measured(9, applied("phase_offset", "", offset_deg=0.5))
    found = searched(cut_beside_own([record], identified())[0], identified())
    assert found.names == ("phase_offset",)
    gain = replace(held(found).gain, gain=gained)
    monkeypatch.setattr("usmbench.diagnose.held.held_out_gain", lambda *_, **__: gain)
    unsure = [replace(ranked, p_value=p_value) for ranked in found.named[0]]
    assert bool(held(replace(found, named=[unsure])).found.named) == stands
