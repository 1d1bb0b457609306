"""What is said beside a verdict."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import applied, judged
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.naming.beside_verdict import said_beside
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.naming.ranking import Ranked
from usmbench.diagnose.naming.verdict import verdict_on
from usmbench.diagnose.residual.whole import Whole
from usmbench.diagnose.result import Verdict


@pytest.mark.parametrize(("p_value", "warns"), [(1e-9, True), (1e-3, False)])
def test_what_is_beyond_chance_in_one_place_is_said(p_value: float, warns: bool) -> None:
    problem = judged(1.0)
    weight = applied("load_torque", "weight", one_sided_rad_s=0.1)
    ranked = [Ranked(weight.effect, Fit((weight,), 60.0, 0.0), 60.0, p_value, 50.0)]
    quiet = Whole(0.0, 1.0, problem.n_rows)
    found = Found(problem, 1.0, ranked, [], Fit((), 0.0, 0.0), quiet, quiet)
    assert verdict_on(found, 0.0) == "no_discrepancy"
    warnings = list(said_beside(found, "no_discrepancy"))
    assert len(warnings) == warns
    assert all(
        w.startswith("load_torque explains") and "drive the plan again" in w for w in warnings
    )


@pytest.mark.parametrize(("share", "warns"), [(1.1, False), (0.1, True)])
def test_steps_larger_than_any_the_model_was_identified_on_are_said(
    share: float, warns: bool
) -> None:
    problem = judged(1.0)
    step_rad_s = np.abs(problem.stretches[0].step_rad_s).max()
    sizes = np.full_like(problem.noise.step_rad_s, share * step_rad_s)
    problem.noise = replace(problem.noise, step_rad_s=sizes)
    quiet = Whole(0.0, 1.0, problem.n_rows)
    found = Found(problem, 1.0, [], [], Fit((), 0.0, 0.0), quiet, quiet)
    warnings = list(said_beside(found, "explained"))
    assert len(warnings) == warns
    assert all("identify it on a run with such steps as well" in w for w in warnings)


@pytest.mark.parametrize(("excess", "warns"), [(0.2, True), (0.3, False)])
def test_what_the_model_may_owe_is_said_where_nothing_else_is_plain(
    excess: float, warns: bool
) -> None:
    problem = judged(1.0)
    whole = Whole(excess * problem.n_rows, 1e-6, problem.n_rows)
    found = Found(problem, 1.0, [], [], Fit((), 0.0, 0.0), whole, whole)
    said = [w for w in said_beside(found, "unexplained") if "own error" in w]
    assert len(said) == warns
    assert not any("own error" in w for w in said_beside(found, "explained"))


@pytest.mark.parametrize(
    ("share", "verdict", "warns"),
    [
        (0.3, "unexplained", True),
        (0.3, "partly_explained", True),
        (0.3, "explained", False),
        (0.1, "unexplained", False),
    ],
)
def test_a_run_that_may_be_of_another_motor_is_asked_about(
    share: float, verdict: Verdict, *, warns: bool
) -> None:
    problem = judged(1.0)
    (stretch,) = problem.stretches
    other = replace(stretch, simulated_rad_s=(1.0 - share) * stretch.speed_rad_s)
    problem.stretches = (other,)
    quiet = Whole(0.0, 1.0, problem.n_rows)
    found = Found(problem, 1.0, [], [], Fit((), 0.0, 0.0), quiet, quiet)
    assert any("another motor" in said for said in said_beside(found, verdict)) == warns


def test_a_window_that_is_not_judged_makes_no_other_motor() -> None:
    (stretch,) = (whole := judged(1.0)).stretches
    mask, speed_rad_s = stretch.use.copy(), stretch.speed_rad_s.copy()
    mask[50], speed_rad_s[50] = False, 1e6
    problem = whole.with_masks([mask])
    quiet = Whole(0.0, 1.0, problem.n_rows)
    problem.stretches = (replace(stretch, speed_rad_s=speed_rad_s),)
    found = Found(problem, 1.0, [], [], Fit((), 0.0, 0.0), quiet, quiet)
    assert not any("another motor" in said for said in said_beside(found, "unexplained"))


def test_a_ripple_is_said_to_be_at_the_counters_angle() -> None:
    problem = judged(1.0)
    off_centre = applied("encoder_eccentricity", "", cosine=0.01, sine=0.0)
    quiet = Whole(0.0, 1.0, problem.n_rows)
    named = Found(problem, 1.0, [], [[]], Fit((off_centre,), 60.0, 0.0), quiet, quiet)
    (warning,) = said_beside(named, "explained")
    assert warning.startswith("encoder_eccentricity: its angle is that of the counter")
    assert not list(said_beside(replace(named, fit=Fit((), 0.0, 0.0)), "explained"))
