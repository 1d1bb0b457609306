"""Two causes of which neither is found alone."""

import numpy as np
import pytest

from known_motor import applied, driven, identified
from tests.usmbench.diagnose.naming.offset_runs import cut_run, offset
from tests.usmbench.diagnose.naming.searched_runs import searched_run
from usmbench.diagnose.pipeline import searched
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


@pytest.mark.parametrize(
    ("offset_deg", "asymmetry"),
    [(-0.3, 0.01), (-0.6, 0.02), (0.6, 0.02)],
    ids=["against it", "more against it", "with it, much like a weight"],
)
def test_an_offset_and_teeth_that_lean_are_both_named(
    model: HammersteinModel, offset_deg: float, asymmetry: float
) -> None:
    lean = applied("gain_asymmetry", "balanced", asymmetry=asymmetry)
    found = searched(cut_run(model, offset(offset_deg), lean, stairs=True), model)
    values = {a.effect.name: a.values for a in found.fit.effects}
    assert sorted(found.names) == ["gain_asymmetry", "phase_offset"]
    assert values["phase_offset"]["offset_deg"] == pytest.approx(offset_deg, abs=0.02)
    assert values["gain_asymmetry"]["asymmetry"] == pytest.approx(asymmetry, abs=1e-3)


def test_an_offset_and_another_scale_are_both_named(model: HammersteinModel) -> None:
    """Though what fits best alone is neither: a drag and steps make up for the two."""
    scaled = applied("phase_scale", "", scale_error=-0.01)
    found = searched(cut_run(model, offset(-0.26), scaled, stairs=True), model)
    values = {a.effect.name: a.values for a in found.fit.effects}
    assert sorted(found.names) == ["phase_offset", "phase_scale"]
    assert values["phase_offset"]["offset_deg"] == pytest.approx(-0.26, abs=0.02)
    assert values["phase_scale"]["scale_error"] == pytest.approx(-0.01, abs=1e-3)


def test_an_offset_and_another_scale_pass_for_no_grid_and_a_gain(model: HammersteinModel) -> None:
    """At ten levels there is a grid that sets each of them about where the two do."""
    rng = np.random.default_rng(202)
    levels_deg = np.sort(rng.uniform(-88.0, 88.0, rng.integers(8, 24)))
    phase_deg = np.repeat(rng.permutation(np.resize(levels_deg, 70)), 20)
    scaled = applied("phase_scale", "", scale_error=-0.0144)
    record = driven(phase_deg, 202, scaled, offset(0.358))
    found = searched_run(record, model)
    values = {a.effect.name: a.values for a in found.fit.effects}
    assert sorted(found.names) == ["phase_offset", "phase_scale"]
    assert values["phase_offset"]["offset_deg"] == pytest.approx(0.358, abs=0.02)
    assert values["phase_scale"]["scale_error"] == pytest.approx(-0.0144, abs=1e-3)
