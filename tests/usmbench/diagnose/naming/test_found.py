"""What speaks against a name: that it leaves too much, or is at an end of what it may be."""

import pytest

from known_motor import applied, judged
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.naming.found import Found
from usmbench.diagnose.residual.whole import Whole
from usmbench.model.applied import Applied


@pytest.mark.parametrize(("spread", "mostly_left"), [(1.2, False), (1.8, True)])
def test_a_noise_that_has_grown_to_a_finding_is_left_by_a_name(
    spread: float, mostly_left: bool
) -> None:
    problem = judged(spread)
    fit = Fit((), 0.1 * problem.deviance, 0.0)
    quiet = Whole(0.0, 1.0, problem.n_rows)
    assert Found(problem, spread, [], [], fit, quiet, quiet).mostly_left == mostly_left


@pytest.mark.parametrize(
    ("applied_", "ends"),
    [
        (applied("thermal_drift", "speed", final_drift=1.0, warm_up_s=1000.0), True),
        (applied("thermal_drift", "speed", final_drift=-1.0, warm_up_s=1000.0), False),
        (applied("missed_counts", "of all", share_lost=1.0, above_rad_s=5.0), False),
        (applied("phase_offset", "", offset_deg=60.0), True),
    ],
    ids=["twice the speed", "none of it", "all counts", "the end of a search"],
)
def test_a_size_that_is_all_it_may_be_explains_nothing(applied_: Applied, *, ends: bool) -> None:
    problem = judged(1.0)
    quiet = Whole(0.0, 1.0, problem.n_rows)
    found = Found(problem, 1.0, [], [], Fit((applied_,), 60.0, 0.0), quiet, quiet)
    assert found.at_an_end == ends


def _found(hidden: Applied, fitted: Applied) -> Found:
    """Return what naming one effect comes to where another is hidden."""
    problem = judged(1.0)
    changed = problem.change_rad_s([hidden])
    for residual, change in zip(problem.residual_rad_s, changed, strict=True):
        residual += change
    again = problem.weighed(problem.noise, problem.masks)
    quiet = Whole(0.0, 1.0, again.n_rows)
    return Found(again, 1.0, [], [], Fit((fitted,), 1e4, 0.0), quiet, quiet)


@pytest.mark.parametrize(
    ("period_s", "damping", "ends"),
    [(0.04, 0.5, False), (0.04, 0.8, True), (0.02, 0.5, True)],
    ids=["seen", "damped more than any that is tried", "as short as windows show"],
)
def test_a_ringing_at_an_end_of_what_is_seen_is_something_else(
    period_s: float, damping: float, *, ends: bool
) -> None:
    ringing = applied("shaft_compliance", "", period_s=period_s, damping=damping)
    assert _found(ringing, ringing).at_an_end == ends


@pytest.mark.parametrize("warm_up_s", [2.0, 3.0], ids=["over before it began", "a warm-up"])
def test_a_warm_up_that_is_over_at_once_is_another_gain(warm_up_s: float) -> None:
    fitted = applied("thermal_drift", "speed", final_drift=0.05, warm_up_s=warm_up_s)
    over = warm_up_s == 2.0  # the soonest that is tried
    hidden = applied("speed_scale", "", scale_error=0.05) if over else fitted
    assert _found(hidden, fitted).at_an_end == over
