"""Two causes of which neither is found alone."""

import pytest

from known_motor import applied, identified, measured, problem_of
from tests.usmbench.diagnose.naming.offset_runs import assert_both_named, cut_run, offset
from usmbench.diagnose.naming.pairs import smooth_pair
from usmbench.diagnose.naming.ranking import rank
from usmbench.diagnose.pipeline import searched
from usmbench.model.effects.registry import library
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


def test_an_offset_and_teeth_that_lean_against_it_are_both_named(model: HammersteinModel) -> None:
    lean = applied("gain_asymmetry", "balanced", asymmetry=0.02)
    found = searched(cut_run(model, offset(-0.6), lean, stairs=True), model)
    assert_both_named(found, -0.6, lean)


def test_of_causes_that_are_all_on_a_grid_none_are_smooth() -> None:
    problem = problem_of([measured(5, applied("phase_quantisation", "cut off", step_deg=3.0))])
    grids = [e for e in library() if e.name == "phase_quantisation"]
    ranked = rank(problem, grids, 1.0)
    assert smooth_pair(problem, ranked, grids, 1.0, ranked[0].fit) is None
