"""What causes bring beside others, without another scan."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import applied, driven, problem_of
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.naming.ranking import Ranked
from usmbench.diagnose.naming.roughly_beside import roughly_beside, roughly_together
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied

OFFSET = applied("phase_offset", "", offset_deg=0.4)
SCALE = applied("speed_scale", "", scale_error=-0.03)
GRID = applied("phase_quantisation", "rounded", step_deg=4.5)


@pytest.fixture(scope="module")
def problem() -> Problem:
    phase_deg = np.repeat(np.random.default_rng(4).uniform(-88.0, 88.0, 150), 10)
    return problem_of([driven(phase_deg, 4, OFFSET, GRID)])


def found(problem: Problem, one: Applied) -> Ranked:
    fit = Fit((one,), problem.drop((one,)), 0.0)
    return Ranked(one.effect, fit, fit.statistic, 0.0, fit.statistic)


def test_a_size_is_fitted_anew_and_what_was_scanned_is_not(problem: Problem) -> None:
    large = applied("phase_offset", "", offset_deg=3.0)
    (sized, brought), (same, beside) = roughly_beside(
        problem, [found(problem, large), found(problem, GRID)], (SCALE,)
    )
    assert sized.fit.effects[-1].values["offset_deg"] == pytest.approx(0.4, abs=0.2)
    assert brought == pytest.approx(
        problem.drop(sized.fit.effects) - problem.drop((SCALE,)), rel=0.1
    )
    assert same.fit.effects == (GRID,)
    assert beside == pytest.approx(problem.drop((SCALE, GRID)) - problem.drop((SCALE,)))


def test_what_passes_for_something_else_is_left_out(problem: Problem) -> None:
    doubtful = replace(found(problem, OFFSET), misfit=1.0)
    assert list(roughly_beside(problem, [doubtful], (SCALE,))) == []


def test_a_cause_and_the_best_beside_it_are_refined_together(problem: Problem) -> None:
    others = [found(problem, one) for one in (SCALE, GRID, OFFSET)]
    both = roughly_together(problem, found(problem, OFFSET).fit, others)
    assert [a.effect.name for a in both.effects] == ["phase_offset", "phase_quantisation"]
    assert both.statistic == pytest.approx(problem.drop((OFFSET, GRID)), rel=0.01)


def test_a_cause_beside_which_there_is_none_stays_alone(problem: Problem) -> None:
    alone = found(problem, OFFSET)
    assert roughly_together(problem, alone.fit, [alone]) is alone.fit
