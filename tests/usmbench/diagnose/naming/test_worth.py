"""What a cause has to bring to be worth a name."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from known_motor import applied, driven, identified, problem_of
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.fitting.fit import NOTHING, Fit
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.worth import First, worth_a_name
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.whole import Whole
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context

LATE = applied("transport_delay", "", delay_s=0.006)
WARMS = applied("thermal_drift", "speed", final_drift=-0.01, warm_up_s=15.0)
EVERYWHERE, ONE_PLACE = [80.0, 100.0, 60.0, 80.0], [20.0, 20.0, 260.0, 20.0]


@pytest.fixture(scope="module")
def problem() -> Problem:
    """Return a run of a motor that follows late and warms."""
    phase_deg = np.repeat(np.random.default_rng(3).uniform(-88.0, 88.0, 100), 20)
    return problem_of([driven(phase_deg, 13, LATE, WARMS)])


def _fit(problem: Problem, *effects: Applied) -> Fit:
    left = problem.left(effects)
    return Fit(effects, problem.deviance - float(left @ left), 0.0)


@pytest.mark.parametrize(
    ("unseen", "first", "worth"),
    [(EVERYWHERE, 1e5, True), (ONE_PLACE, 1e5, False), (EVERYWHERE, 1e8, False)],
    ids=["in its own right", "in one place", "next to nothing beside the first"],
)
def test_a_further_cause_is_asked_for_more(
    problem: Problem, unseen: list[float], first: float, worth: bool
) -> None:
    before, longer = _fit(problem, LATE), _fit(problem, LATE, WARMS)
    assert worth_a_name(problem, before, longer, np.array(unseen), First(first), 1.0) == worth


@pytest.mark.parametrize(
    ("unseen", "worth"),
    [
        (ONE_PLACE, True),
        ([0.0, 0.0, 300.0, -1.0], False),
        ([900.0, 800.0, -40.0, 700.0], True),
        ([900.0, 800.0, -400.0, 700.0], False),
        ([9.0, 8.0, -4.0, 7.0], True),
    ],
)
def test_a_first_cause_may_hold_unevenly_but_not_in_one_place_alone_nor_turn_against_one(
    problem: Problem, unseen: list[float], worth: bool
) -> None:
    fit = _fit(problem, LATE)
    assert worth_a_name(problem, NOTHING, fit, np.array(unseen), First(), 1.0) == worth


@dataclass(frozen=True)
class _Standing(Effect):
    """A rotor that stands at some stays of the phase, of 20 windows each."""

    stays: tuple[int, ...]
    name = "standing"
    meaning = mend = "None."
    stage = "counter"
    parameters = ()

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        return np.where(np.isin(np.arange(context.n) // 20, self.stays), 0.0, signal)


@pytest.mark.parametrize(("stays", "worth"), [((20,), False), ((20, 41), True)])
def test_one_stay_of_the_phase_is_an_accident(stays: tuple[int, ...], *, worth: bool) -> None:
    phase_deg = np.repeat(np.random.default_rng(3).uniform(-88.0, 88.0, 100), 20)
    phase_deg[20 * 20 : 21 * 20] = phase_deg[41 * 20 : 42 * 20] = 16.0
    stands = Applied(_Standing(stays), {})
    problem = problem_of([driven(phase_deg, 13, stands)])
    fit = _fit(problem, stands)
    assert worth_a_name(problem, NOTHING, fit, np.array(EVERYWHERE), First(), 1.0) == worth


@pytest.mark.parametrize(("visits", "worth"), [(1, False), (12, True)])
def test_a_long_stay_in_which_chance_strikes_does_not_hide_the_short_ones(
    visits: int, *, worth: bool
) -> None:
    long, short = np.full(300, 88.0), np.repeat(np.random.default_rng(4).uniform(-40, 40, 300), 4)
    short[: 8 * (visits - 1)].reshape(-1, 8)[:, :4] = 88.0
    loses = applied("missed_counts", "of all", share_lost=0.5, above_rad_s=9.9)
    problem = problem_of([driven(np.r_[long, short], 13, loses)])
    fit = _fit(problem, loses)
    assert worth_a_name(problem, NOTHING, fit, np.array(EVERYWHERE), First(), 1.0) == worth


LEANS = applied("gain_asymmetry", "balanced", asymmetry=0.05)
GRID = applied("phase_quantisation", "rounded", step_deg=3.0)


@pytest.mark.parametrize(
    ("first_is", "kept", "share", "worth"),
    [
        (LATE, 0.95, 0.005, True),
        (LATE, 0.85, 0.005, True),
        (LATE, 0.85, 0.0005, False),
        (LEANS, 0.85, 0.005, False),
        (LEANS, 0.1, 0.02, True),
        (GRID, 0.95, 0.0005, False),
        (GRID, 0.95, 0.005, True),
    ],
    ids=[
        "another",
        "too much for what is defined",
        "a misfit even of that",
        "a misfit",
        "too much for one",
        "beside what is jagged",
        "too much beside it",
    ],
)
def test_a_cause_that_may_be_a_misfit_of_the_first_is_asked_for_more(
    problem: Problem,
    monkeypatch: pytest.MonkeyPatch,
    first_is: Applied,
    kept: float,
    share: float,
    worth: bool,
) -> None:
    before, longer = _fit(problem, first_is), _fit(problem, first_is, WARMS)
    brings = 1000.0
    found = iter([brings, kept * brings])
    monkeypatch.setattr("usmbench.diagnose.naming.worth._gained", lambda *_: next(found))
    first = brings / share  # of which a form that is a tenth off leaves a hundredth
    assert worth_a_name(problem, before, longer, np.array(EVERYWHERE), First(first), 1.0) == worth


@pytest.mark.parametrize(
    ("brings", "kept", "first", "worth"),
    [
        (30.0, 1.0, First(1e3), True),
        (15.0, 1.0, First(1e3), False),
        (30.0, 1.0, First(1e3, frozenset({"slow_dynamics"})), False),
        (35.0, 1.0, First(4e3), False),
        (45.0, 1.0, First(4e3), True),
        (60.0, 1.0, First(2e4), False),
        (110.0, 1.0, First(2e4), True),
        (50.0, 0.8, First(1e3), False),
        (70.0, 0.8, First(1e3), True),
    ],
)
def test_a_second_cause_has_to_bring_something_of_its_own(
    problem: Problem,
    monkeypatch: pytest.MonkeyPatch,
    brings: float,
    kept: float,
    first: First,
    worth: bool,
) -> None:
    found = iter([brings, kept * brings])
    monkeypatch.setattr("usmbench.diagnose.naming.worth._gained", lambda *_: next(found))
    before, longer = _fit(problem, LATE), _fit(problem, LATE, WARMS)
    assert worth_a_name(problem, before, longer, np.array(EVERYWHERE), first, 1.0) == worth


@pytest.mark.parametrize(
    ("rivals", "worth"),
    [((), True), (("thermal_drift",), True), (("slow_dynamics",), False)],
    ids=["none", "the second itself", "a third"],
)
def test_a_cause_that_a_third_may_stand_for_is_no_definition(
    problem: Problem, monkeypatch: pytest.MonkeyPatch, rivals: tuple[str, ...], worth: bool
) -> None:
    before, longer = _fit(problem, LATE), _fit(problem, LATE, WARMS)
    found = iter([1000.0, 500.0])
    monkeypatch.setattr("usmbench.diagnose.naming.worth._gained", lambda *_: next(found))
    first = First(2e5, frozenset(rivals))
    assert worth_a_name(problem, before, longer, np.array(EVERYWHERE), first, 1.0) == worth


@pytest.mark.parametrize(("left", "worth"), [(20.0, True), (200.0, False)])
def test_beside_a_grid_a_cause_that_takes_all_the_views_show_needs_no_more(
    problem: Problem, monkeypatch: pytest.MonkeyPatch, left: float, worth: bool
) -> None:
    before, longer = _fit(problem, GRID), _fit(problem, GRID, WARMS)
    found = iter([1000.0, 950.0])
    excess = iter([1000.0, left])
    monkeypatch.setattr("usmbench.diagnose.naming.worth._gained", lambda *_: next(found))
    monkeypatch.setattr(
        "usmbench.diagnose.naming.worth.whole_test", lambda *_: Whole(next(excess), 0.0, 2000)
    )
    first = First(2e6)
    assert worth_a_name(problem, before, longer, np.array(EVERYWHERE), first, 1.0) == worth


@pytest.mark.parametrize(("first", "worth"), [(1e5, True), (1e7, False)])
def test_of_two_that_are_weighed_anew_each_has_to_earn_its_place(
    problem: Problem, first: float, worth: bool
) -> None:
    before, turned = _fit(problem, LATE), _fit(problem, WARMS, LATE)
    assert worth_a_name(problem, before, turned, np.array(EVERYWHERE), First(first), 1.0) == worth


@pytest.mark.parametrize(("wander", "worth"), [(0.05, True), (0.5, False)])
def test_what_the_gain_would_have_to_be_off_by_stands_in_no_row(
    monkeypatch: pytest.MonkeyPatch, wander: float, worth: bool
) -> None:
    # Gains that wander by 5 % make up for swapped channels at forty times that.
    swapped = applied("swapped_channels", "")
    phase_deg = np.repeat(np.random.default_rng(3).uniform(-88.0, 88.0, 100), 20)
    model = identified()
    (stretch,), _ = cut_runs([driven(phase_deg, 13, swapped)], model, ())
    known = knowledge_of(model)
    known = replace(known, wander=replace(known.wander, gain=wander))
    noise = known.noise
    assert noise is not None
    problem = Problem([stretch], known, noise, [stretch.use])
    left = float(np.sum(problem.residual[: problem.n_rows] ** 2))
    fit = _fit(problem, swapped)
    beyond = problem.deviance - left
    in_one_row = np.r_[fit.statistic - beyond, np.zeros(problem.n_rows - 1)]
    monkeypatch.setattr("usmbench.diagnose.naming.worth._by_row", lambda *_: in_one_row)
    assert worth_a_name(problem, NOTHING, fit, np.array(EVERYWHERE), First(), 1.0) == worth
