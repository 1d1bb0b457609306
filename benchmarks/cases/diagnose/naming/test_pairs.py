"""Two causes of which neither is found alone."""

import numpy as np
import pytest

from known_motor import applied, driven
from tests.usmbench.diagnose.naming.offset_runs import assert_both_named, cut_run, offset
from tests.usmbench.diagnose.naming.searched_runs import searched_run
from usmbench.diagnose.naming.pairs import hidden_pair
from usmbench.diagnose.naming.ranking import rank
from usmbench.diagnose.pipeline import searched
from usmbench.model.applied import Applied
from usmbench.model.effects.registry import library
from usmbench.model.hammerstein import HammersteinModel

STEP_DEG = 360.0 / 256.0
COARSE = applied("phase_quantisation", "cut off", step_deg=STEP_DEG)


@pytest.mark.parametrize("offset_deg", [-0.6, 0.8])
def test_a_register_and_an_offset_are_both_named(
    model: HammersteinModel, offset_deg: float
) -> None:
    found = searched(cut_run(model, COARSE, offset(offset_deg)), model)
    values = {a.effect.name: a.values for a in found.fit.effects}
    assert sorted(found.names) == ["phase_offset", "phase_quantisation"]
    assert values["phase_quantisation"]["step_deg"] == pytest.approx(STEP_DEG, rel=5e-3)
    assert values["phase_offset"]["offset_deg"] == pytest.approx(offset_deg, abs=0.02)


@pytest.mark.parametrize(
    ("step_deg", "one_sided_rad_s"), [(0.71, -0.05), (1.13, -0.14), (2.06, 0.14)]
)
def test_a_weight_that_makes_up_for_half_a_step_is_named_beside_the_register(
    model: HammersteinModel, step_deg: float, one_sided_rad_s: float
) -> None:
    """Alone the register then looks like another form of itself, or like none."""
    register = applied("phase_quantisation", "cut off", step_deg=step_deg)
    weight = applied("load_torque", "weight", one_sided_rad_s=one_sided_rad_s)
    found = searched(cut_run(model, register, weight), model)
    values = {a.effect.name: a.values for a in found.fit.effects}
    assert sorted(found.names) == ["load_torque", "phase_quantisation"]
    assert values["phase_quantisation"]["step_deg"] == pytest.approx(step_deg, rel=5e-3)
    assert values["load_torque"]["one_sided_rad_s"] == pytest.approx(one_sided_rad_s, abs=5e-3)


@pytest.mark.parametrize(
    ("hidden", "stairs"),
    [
        ((), True),
        ((offset(0.7),), True),
        ((COARSE,), False),
        ((applied("unsigned_counts", ""),), False),
        ((applied("coupling_backlash", "", gap_rad=0.02),), False),
        ((applied("load_torque", "weight", one_sided_rad_s=-0.1),), True),
    ],
    ids=["nothing", "an offset", "a register", "unsigned counts", "backlash", "a weight"],
)
def test_what_is_one_cause_is_no_pair(
    model: HammersteinModel, hidden: tuple[Applied, ...], stairs: bool
) -> None:
    problem = searched(cut_run(model, *hidden, stairs=stairs), model).problem
    effects = [
        e
        for e in library()
        if not e.sporadic and e.untestable([s.context for s in problem.stretches]) is None
    ]
    assert hidden_pair(problem, rank(problem, effects, 1.0), effects, 1.0) is None


@pytest.mark.parametrize(
    ("offset_deg", "asymmetry"),
    [(-0.3, 0.01), (0.6, 0.02)],
    ids=["against it", "with it, much like a weight"],
)
def test_an_offset_and_teeth_that_lean_are_both_named(
    model: HammersteinModel, offset_deg: float, asymmetry: float
) -> None:
    lean = applied("gain_asymmetry", "balanced", asymmetry=asymmetry)
    found = searched(cut_run(model, offset(offset_deg), lean, stairs=True), model)
    assert_both_named(found, offset_deg, lean)


def test_an_offset_and_another_scale_are_both_named(model: HammersteinModel) -> None:
    """Though what fits best alone is neither: a drag and steps make up for the two."""
    scaled = applied("phase_scale", "", scale_error=-0.01)
    found = searched(cut_run(model, offset(-0.26), scaled, stairs=True), model)
    assert_both_named(found, -0.26, scaled)


def test_an_offset_and_another_scale_pass_for_no_grid_and_a_gain(model: HammersteinModel) -> None:
    """At ten levels there is a grid that sets each of them about where the two do."""
    rng = np.random.default_rng(202)
    levels_deg = np.sort(rng.uniform(-88.0, 88.0, rng.integers(8, 24)))
    phase_deg = np.repeat(rng.permutation(np.resize(levels_deg, 70)), 20)
    scaled = applied("phase_scale", "", scale_error=-0.0144)
    record = driven(phase_deg, 202, scaled, offset(0.358))
    found = searched_run(record, model)
    assert_both_named(found, 0.358, scaled)


def test_an_offset_and_teeth_that_lean_against_it_are_both_named(model: HammersteinModel) -> None:
    lean = applied("gain_asymmetry", "balanced", asymmetry=0.02)
    found = searched(cut_run(model, offset(-0.6), lean, stairs=True), model)
    assert_both_named(found, -0.6, lean)
