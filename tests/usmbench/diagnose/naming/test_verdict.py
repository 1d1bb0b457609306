"""Whether what is named may stand beside what it leaves."""

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, applied, judged
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.ranking import Ranked
from usmbench.diagnose.naming.verdict import by_share_left, verdict_on
from usmbench.diagnose.residual.whole import Whole
from usmbench.diagnose.result import Verdict

N_ROWS = 1000


@pytest.mark.parametrize(
    ("left", "verdict"), [(450.0, "partly_explained"), (950.0, "unexplained")], ids=["less", "more"]
)
def test_scatter_excuses_a_name_beside_less_than_it_explains(
    left: float, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = judged(1.4)  # and so much scatter that what the views show is little of it
    lost = applied("missed_counts", "of all", share_lost=0.05, above_rad_s=9.0)
    fit = Fit((lost,), 900.0, 0.0)
    named = [[Ranked(lost.effect, fit, 900.0, 0.0, 900.0)]]
    before, after = (Whole(excess, 0.0, problem.n_rows) for excess in (1000.0, left))
    monkeypatch.setattr("usmbench.diagnose.naming.verdict.leaves_scatter", lambda *_: True)
    assert verdict_on(Found(problem, 1.0, [], named, fit, before, after), 0.0) == verdict


@pytest.mark.parametrize(
    ("left", "verdict"),
    [(0.04, "partly_explained"), (0.06, "no_discrepancy")],
    ids=["less", "more"],
)
def test_a_name_that_leaves_more_than_it_explains_is_none(left: float, verdict: str) -> None:
    """However small both are: something else is the matter."""
    problem = judged(1.0)
    weight = applied("load_torque", "weight", one_sided_rad_s=0.01)
    fit = Fit((weight,), 0.05 * problem.n_rows, 0.0)
    named = [[Ranked(weight.effect, fit, fit.statistic, 0.0, fit.statistic)]]
    before, after = (Whole(share * problem.n_rows, 1e-9, problem.n_rows) for share in (0.1, left))
    assert verdict_on(Found(problem, 1.0, [], named, fit, before, after), 0.0) == verdict


@pytest.mark.parametrize(
    ("asymmetry", "shown", "verdict"),
    [
        (0.3, 9e3, "explained"),
        (1.5, 9e3, "unexplained"),
        (-1.5, 9e3, "unexplained"),
        (1.5, 0.0, "no_discrepancy"),
    ],
)
def test_a_size_that_is_all_it_may_be_is_no_explanation(
    asymmetry: float, shown: float, verdict: str
) -> None:
    problem = judged(1.0)
    cause = applied("gain_asymmetry", "balanced", asymmetry=asymmetry)
    fit = Fit((cause,), 9e3, 0.0)
    named = [[Ranked(cause.effect, fit, 9e3, 0.0, 9e3)]]
    before, after = Whole(shown, 0.0, problem.n_rows), Whole(0.0, 1.0, problem.n_rows)
    assert verdict_on(Found(problem, 1.0, [], named, fit, before, after), 0.0) == verdict


@pytest.mark.parametrize(("share", "verdict"), [(0.05, "explained"), (0.15, "unexplained")])
def test_a_name_beside_something_smooth_that_has_none_is_a_patch(
    share: float, verdict: str
) -> None:
    problem = judged(1.0)
    weight = applied("load_torque", "weight", one_sided_rad_s=0.1)
    fit = Fit((weight,), 2e3, 0.0)
    named = [[Ranked(weight.effect, fit, 2e3, 0.0, 2e3)]]
    before, after = Whole(4e3, 0.0, problem.n_rows), Whole(share * 2000.0, 0.0, problem.n_rows)
    assert verdict_on(Found(problem, 1.0, [], named, fit, before, after), 0.0) == verdict


@pytest.mark.parametrize(
    ("name", "form", "values", "verdict"),
    [
        ("load_torque", "weight", {"one_sided_rad_s": 0.1}, "partly_explained"),
        ("phase_quantisation", "rounded", {"step_deg": 1.0}, "unexplained"),
    ],
)
def test_a_grid_of_phases_that_explains_some_is_an_accident(
    name: str, form: str, values: dict[str, float], verdict: str
) -> None:
    problem = judged(1.0)
    cause = applied(name, form, **values)
    fit = Fit((cause,), 200.0, 0.0)
    named = [[Ranked(cause.effect, fit, 200.0, 0.0, 200.0)]]
    before, after = (Whole(excess, 1e-6, problem.n_rows) for excess in (300.0, 90.0))
    assert verdict_on(Found(problem, 1.0, [], named, fit, before, after), 0.0) == verdict


@pytest.mark.parametrize(
    ("share", "p_value", "verdict"),
    [
        (0.2, 1e-6, "no_discrepancy"),
        (0.3, 1e-6, "unexplained"),
        (0.03, 1e-12, "unexplained"),
        (0.01, 1e-12, "no_discrepancy"),
    ],
)
def test_what_has_no_name_counts_window_by_window(
    share: float, p_value: float, verdict: str
) -> None:
    problem = judged(1.0)
    # In a window in which the rotor stops the plain error is large, and tells nothing.
    problem.residual_rad_s[0][100] = 50.0
    found = Whole(share * problem.n_rows, p_value, problem.n_rows)
    fit = Fit((), 0.0, 0.0)
    assert verdict_on(Found(problem, 1.0, [], [], fit, found, found), 0.0) == verdict


@pytest.mark.parametrize(("spread", "verdict"), [(1.2, "no_discrepancy"), (1.4, "unexplained")])
def test_more_noise_than_the_model_knows_is_a_finding(spread: float, verdict: str) -> None:
    problem = judged(spread)
    quiet = Whole(0.0, 1.0, problem.n_rows)
    found = Found(problem, spread, [], [], Fit((), 0.0, 0.0), quiet, quiet)
    assert verdict_on(found, 0.0) == verdict


@pytest.mark.parametrize(("times", "verdict"), [(2.0, "no_discrepancy"), (6.0, "unexplained")])
def test_what_few_rows_show_and_no_view_does_is_unexplained(times: float, verdict: str) -> None:
    problem = judged(1.0)
    problem.residual_rad_s[0][::40] += times * NOISE_RAD_S * np.tile([1.0, -1.0], 25)
    again = problem.weighed(problem.noise, problem.masks)
    quiet = Whole(0.0, 1.0, again.n_rows)
    assert verdict_on(Found(again, 1.0, [], [], Fit((), 0.0, 0.0), quiet, quiet), 0.0) == verdict


@pytest.mark.parametrize(("share", "verdict"), [(0.3, "no_discrepancy"), (0.9, "explained")])
def test_single_windows_are_the_matter_where_most_of_what_is_off_is_in_them(
    share: float, verdict: str
) -> None:
    problem = judged(1.1)
    quiet = Whole(0.0, 1.0, problem.n_rows)
    found = Found(problem, 1.1, [], [], Fit((), 0.0, 0.0), quiet, quiet)
    assert found.off_in_all > 0.0
    assert verdict_on(found, share * found.off_in_all) == verdict


@pytest.mark.parametrize(
    ("excess", "p_value", "says"),
    [
        (50.0, 0.01, "explained"),
        (5.0, 1e-6, "explained"),
        (90.0, 1e-6, "partly_explained"),
        (150.0, 1e-6, "unexplained"),
    ],
    ids=["chance", "a small share", "a trifle", "a finding"],
)
def test_a_name_stands_beside_a_trifle(excess: float, p_value: float, says: Verdict) -> None:
    before, after = Whole(200.0, 0.0, N_ROWS), Whole(excess, p_value, N_ROWS)
    assert by_share_left(before, after, 40.0) == says
