"""Two causes of which neither is found alone."""

import pytest

from known_motor import applied, identified
from tests.usmbench.diagnose.naming.offset_runs import cut_run, offset
from usmbench.diagnose.pipeline import searched
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


def test_an_offset_and_teeth_that_lean_against_it_are_both_named(model: HammersteinModel) -> None:
    lean = applied("gain_asymmetry", "balanced", asymmetry=0.02)
    found = searched(cut_run(model, offset(-0.6), lean, stairs=True), model)
    values = {a.effect.name: a.values for a in found.fit.effects}
    assert sorted(found.names) == ["gain_asymmetry", "phase_offset"]
    assert values["phase_offset"]["offset_deg"] == pytest.approx(-0.6, abs=0.02)
    assert values["gain_asymmetry"]["asymmetry"] == pytest.approx(0.02, abs=1e-3)
