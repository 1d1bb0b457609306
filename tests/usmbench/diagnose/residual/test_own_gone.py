"""What a model was extended by is gone, wholly or in part, alone or beside something new."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from known_motor import applied, driven, identified
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.experiment.next_experiment import question_of
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.residual.free_runs import FreeRuns
from usmbench.diagnose.residual.own_gone import GONE, OwnGone, gone_effects
from usmbench.diagnose.result import Diagnosis
from usmbench.model.applied import Applied

DELAY = applied("transport_delay", "", delay_s=0.008)
DRAG, HALF_A_DRAG = (applied("load_torque", "drag", drag_rad_s=x) for x in (0.1, 0.05))
OFFSET = applied("phase_offset", "", offset_deg=1.0)


def extended_by(own: Sequence[Applied], now: Sequence[Applied]) -> Diagnosis:
    """Return the diagnosis of a motor with some effects by a model that has others."""
    phase_deg = np.repeat(np.random.default_rng(78).uniform(-88.0, 88.0, 150), 10)
    model = replace(identified(), effects=tuple(a.to_mapping() for a in own))
    return diagnose([driven(phase_deg, 57, *now)], model)


def said(found: Diagnosis) -> list[tuple[str, str]]:
    return [(cause.name, cause.form) for cause in found.causes]


@pytest.mark.parametrize("own", [DELAY, DRAG], ids=["delay", "drag"])
def test_what_was_mended_is_told_and_left_out(own: Applied) -> None:
    found = extended_by([own], [])
    assert (found.verdict, said(found)) == ("explained", [(own.effect.name, GONE)])
    (share,) = found.causes[0].parameters
    assert share.low > 0.8
    assert share.high == 1.0
    assert found.extended.effects == ()
    assert found.gain > 0.95
    assert question_of(found) is None


def test_what_is_there_still_is_not_gone() -> None:
    found = extended_by([DELAY], [DELAY])
    assert (found.verdict, said(found)) == ("no_discrepancy", [])


def test_of_two_that_a_model_has_one_is_gone() -> None:
    found = extended_by([OFFSET, DELAY], [OFFSET])
    assert (found.verdict, said(found)) == ("explained", [("transport_delay", GONE)])
    assert found.extended.effects == (OFFSET.to_mapping(),)


def test_something_new_is_named_beside_what_is_gone() -> None:
    found = extended_by([DRAG], [OFFSET])
    assert found.verdict == "explained"
    assert sorted(said(found)) == [("load_torque", GONE), ("phase_offset", "")]
    (entry,) = found.extended.effects
    assert entry["parameters"]["offset_deg"] == pytest.approx(1.0, rel=0.1)


def test_what_has_become_less_stays_by_as_much() -> None:
    found = extended_by([DRAG], [HALF_A_DRAG])
    assert (found.verdict, said(found)) == ("explained", [("load_torque", GONE)])
    (share,) = found.causes[0].parameters
    assert share.low < 0.5 < share.high
    (entry,) = found.extended.effects
    assert entry["parameters"]["drag_rad_s"] == pytest.approx(0.05, rel=0.2)


@pytest.mark.parametrize(("share", "left"), [(0.3, True), (0.7, False)])
def test_of_what_has_no_size_most_is_left_or_nothing(share: float, *, left: bool) -> None:
    grid = applied("phase_quantisation", "rounded", step_deg=4.0)
    (gone,) = gone_effects([grid])
    assert isinstance(gone, OwnGone)
    entry = gone.entry_left({"share_gone": share})
    assert entry == (grid.to_mapping() if left else None)


def test_a_free_run_without_an_effect_is_that_of_a_motor_without_it() -> None:
    phase_deg = np.repeat([-60.0, 40.0, 80.0], 20)
    stretches, _ = cut_runs([driven(np.tile(phase_deg, 10), 3)], identified(), ())
    runs, (gone,) = FreeRuns(stretches), gone_effects([DELAY])
    for share, expected in ((0.0, [DELAY, OFFSET]), (1.0, [OFFSET])):
        less = Applied(gone, {"share_gone": share})
        (speed_rad_s,) = runs.speed_rad_s([DELAY, OFFSET, less])
        (wanted_rad_s,) = runs.speed_rad_s(expected)
        assert np.array_equal(speed_rad_s, wanted_rad_s)
