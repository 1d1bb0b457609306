"""Two causes of which neither is found alone."""

from known_motor import applied, measured, problem_of
from usmbench.diagnose.naming.pairs import smooth_pair
from usmbench.diagnose.naming.ranking import rank
from usmbench.model.effects.registry import library


def test_of_causes_that_are_all_on_a_grid_none_are_smooth() -> None:
    problem = problem_of([measured(5, applied("phase_quantisation", "cut off", step_deg=3.0))])
    grids = [e for e in library() if e.name == "phase_quantisation"]
    ranked = rank(problem, grids, 1.0)
    assert smooth_pair(problem, ranked, grids, 1.0, ranked[0].fit) is None
