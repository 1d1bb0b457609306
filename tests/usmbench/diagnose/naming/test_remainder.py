"""What is left is told by the test that found it."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, judged
from usmbench.diagnose.naming.remainder import Beyond, describe
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.whole import Whole
from usmbench.diagnose.result import View

QUIET = Whole(0.0, 1.0, 1)
NOTHING = Beyond(1000, 3, 1.0, 0.5, 0.5, 0.5, "around 1 s")


def _view(excess: float) -> View:
    size = np.array([0.1 * excess, 0.0])
    band, counts = np.full(2, 0.1), np.full(2, 50.0)
    return View("angle", "", np.array([1.0, 2.0]), size, size, band, counts, excess, excess)


def _off_between_s(low_s: float, high_s: float, times: float, every: int) -> Problem:
    """Return a healthy run with windows of either sign that are off there."""
    problem = judged(1.0)
    t_s = problem.stretches[0].context.t_s
    rows = np.flatnonzero((t_s > low_s) & (t_s < high_s))[::every]
    problem.residual_rad_s[0][rows] += times * NOISE_RAD_S * (-1.0) ** np.arange(rows.size)
    return problem.weighed(problem.noise, problem.masks)


def test_windows_that_no_view_shows_are_counted_and_placed_in_time() -> None:
    problem = _off_between_s(12.0, 14.0, times=8.0, every=10)
    beyond = Beyond.of(problem, (), 1.0, QUIET)
    left = describe([_view(0.7)], 1.0, beyond)
    assert left.versus == "time"
    assert f": {beyond.n_far} of {beyond.n_rows} by more than 3 times the noise" in left.says
    assert beyond.n_far >= 20
    assert 12.0 < float(left.says.split("most around ")[1].removesuffix(" s")) < 14.0
    assert "0.7" not in left.says


def test_all_windows_together_are_told_where_no_single_one_is_off() -> None:
    beyond = Beyond.of(_off_between_s(0.0, 20.0, times=0.6, every=1), (), 1.0, QUIET)
    assert beyond.p_rows < 1e-6
    says = describe([_view(0.7)], 1.0, replace(beyond, n_far=6)).says
    assert says.startswith("all windows together show more than noise leaves")
    assert f"{beyond.times_noise:.3g} times as much (root mean square)" in says
    assert beyond.times_noise > 1.08


def test_views_that_only_together_show_something_are_told_together() -> None:
    together = replace(QUIET, p_value=2e-9)
    says = Beyond.of(judged(1.0), (), 1.0, together).says()
    assert says.startswith("all views together")
    assert says.endswith("in one run of 5e+08")
    assert "together" not in Beyond.of(judged(1.0), (), 1.0, QUIET).says()


def test_an_error_that_only_the_model_could_have_is_called_so() -> None:
    assert "error of the model itself" in replace(NOTHING, p_excused=1e-9).says()
    assert "resembles a cause" in NOTHING.says()


def test_of_several_runs_the_one_that_leaves_most_is_named() -> None:
    problem = judged(1.0)
    (stretch,), (mask,) = problem.stretches, problem.masks
    runs = [replace(stretch, name="first"), replace(stretch, name="second")]
    both = Problem(runs, problem.known, problem.noise, [mask, mask])
    both.residual_rad_s[1][500:600] += 5.0 * NOISE_RAD_S * (-1.0) ** np.arange(100)
    both = both.weighed(both.noise, both.masks)
    assert Beyond.of(both, (), 1.0, QUIET).where.endswith(" s of second")


@pytest.mark.parametrize(
    ("excess", "spread", "versus"),
    [
        (0.7, 1.4, "noise"),
        (1.2, 1.4, "angle"),
        (1.2, 1.6, "noise"),
        (1.2, 1.0, "angle"),
        (2.0, 1.6, "angle"),
    ],
)
def test_a_view_or_the_scatter_that_shows_it_comes_first(
    excess: float, spread: float, versus: str
) -> None:
    assert describe([_view(excess)], spread, NOTHING).versus == versus


def test_without_a_view_or_a_test_it_resembles_a_cause() -> None:
    assert "resembles a cause" in describe([_view(0.7)], 1.0).says
