"""What a search sets aside as exceptions, and what it finds beside them."""

from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, applied, driven, identified, measured
from tests.usmbench.diagnose.naming.searched_runs import judged_rows, names_of, searched_run
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming import search as searching
from usmbench.diagnose.naming.search import search
from usmbench.diagnose.result import Verdict
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


def test_steps_that_a_trembling_delay_leaves_off_to_either_side_are_no_exceptions(
    model: HammersteinModel,
) -> None:
    rng = np.random.default_rng(34)
    phase_deg = np.repeat(np.resize([1.0, -1.0], 30) * rng.uniform(60.0, 88.0, 30), 20)
    sooner, later = (
        driven(phase_deg, 34, applied("transport_delay", "", delay_s=late_s)).speed_rad_s
        for late_s in (0.00375, 0.00425)
    )
    which = np.repeat(rng.random(30) < 0.5, 20)
    record = replace(driven(phase_deg, 34), speed_rad_s=np.where(which, sooner, later))
    found = searched_run(record, model)
    assert names_of(found) == {"transport_delay"}
    assert judged_rows(found, np.arange(20, 600, 20)).all()
    assert found.fit.effects[0].values["delay_s"] == pytest.approx(0.004, abs=0.0005)


@pytest.mark.parametrize("slip_limit_rad_s", [None, 3.0])
def test_what_a_faster_run_shows_of_an_effect_is_not_the_size_of_its_cause(
    model: HammersteinModel, slip_limit_rad_s: float | None
) -> None:
    known, faster = knowledge_of(model), 1.03
    known = replace(known, wander=replace(known.wander, gain=0.02))
    limited = replace(model, linear=replace(model.linear, slip_limit_rad_s=slip_limit_rad_s))
    offset = applied("phase_offset", "", offset_deg=2.0)
    record = measured(33)
    ((stretch,), _) = cut_runs([record], limited, ())
    context, noise = stretch.context, np.random.default_rng(33)
    shown = extended_run([offset], context).speed_rad_s
    noisy = faster * shown + NOISE_RAD_S * noise.standard_normal(shown.size)
    found = search([replace(stretch, speed_rad_s=noisy)], known, (), [offset.effect])
    assert found.fit.effects[0].values["offset_deg"] == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize(
    ("says", "stands"),
    [("explained", True), ("partly_explained", True), ("unexplained", False)],
)
def test_two_at_once_stand_beside_the_scatter_that_chance_leaves(
    says: Verdict, *, stands: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside two names a verdict of partly_explained says that scatter is all that is left."""
    alone, both, weighed = Mock(spread=1.5), Mock(spread=1.4), Mock()
    weighed.found.return_value = both
    monkeypatch.setattr(searching, "hidden_pair", lambda *_: Mock())
    monkeypatch.setattr(searching, "verdict_on", lambda *_: says)
    found = searching._with_a_pair(weighed, None, alone, [])
    assert found is (both if stands else alone)
