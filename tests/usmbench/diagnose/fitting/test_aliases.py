"""Grids that few phases hardly tell apart: the one that is there is found, and told how surely."""

import numpy as np
import pytest

from known_motor import applied, driven, identified, measured, problem_of
from usmbench.diagnose.fitting.aliases import alias_range, on_best_alias
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.intervals import intervals
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.runs.record import Record


def _grid(step_deg: float) -> Applied:
    return applied("phase_quantisation", "cut off", step_deg=step_deg)


def _levels(seed: int, n: int, *, even: bool, hidden: Applied) -> Record:
    rng = np.random.default_rng(seed)
    levels_deg = np.linspace(-85.0, 85.0, n) if even else rng.uniform(-88.0, 88.0, n)
    return driven(np.repeat(rng.permutation(np.resize(levels_deg, 100)), 9), seed, hidden)


def _holds(problem: Problem, found: Fit, step_deg: float) -> tuple[float, float]:
    """Return the interval, which holds a step but for a thousandth of it."""
    (low_deg, high_deg) = intervals(problem, found, 1.0)[0]["step_deg"]
    assert low_deg / 1.001 < step_deg < 1.001 * high_deg
    return low_deg, high_deg


@pytest.mark.parametrize("seed", range(4))
def test_the_grid_that_is_there_is_found_from_another(seed: int) -> None:
    rng = np.random.default_rng([seed, 1])
    step_deg, times = float(rng.uniform(0.4, 1.5)), float(rng.uniform(0.6, 1.6))
    problem = problem_of([_levels(seed, 23 + seed, even=False, hidden=_grid(step_deg))])
    other = refine(problem, Fit((_grid(times * step_deg),), 0.0, 0.0))
    found = on_best_alias(problem, other)
    assert found.statistic >= problem.drop([_grid(step_deg)]) - 1e-9
    _holds(problem, found, step_deg)


@pytest.mark.parametrize("seed", range(5, 8))
def test_all_that_fit_as_well_are_in_the_interval(seed: int) -> None:
    """Of a step so fine that nine phases leave it open by several per cent."""
    problem = problem_of([_levels(seed, 9, even=False, hidden=_grid(0.1663))])
    found = on_best_alias(problem, refine(problem, Fit((_grid(0.15),), 0.0, 0.0)))
    low_deg, high_deg = _holds(problem, found, 0.1663)
    assert high_deg - low_deg > 0.01


def test_phases_enough_tell_a_grid_from_all_others() -> None:
    problem = problem_of([measured(5, _grid(1.0))])
    fit = Fit((_grid(1.1),), 0.0, 0.0)
    assert on_best_alias(problem, fit) is fit
    assert alias_range(problem, _grid(1.1), (), 4.0) == (1.1, 1.1)


def test_a_grid_between_those_of_the_scan_explains_all() -> None:
    (cause,) = (
        found := diagnose([_levels(8, 24, even=True, hidden=_grid(0.692))], identified())
    ).causes
    assert (found.verdict, cause.name) == ("explained", "phase_quantisation")
    assert found.gain > 0.95
    assert cause.parameters[0].value == pytest.approx(0.692, abs=0.002)
