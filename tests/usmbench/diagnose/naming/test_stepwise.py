"""Which causes are named, one after the other."""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np
import pytest

import known_motor
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.fitting.fit import NOTHING, Fit
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming import stepwise
from usmbench.diagnose.naming.ranking import Ranked, rank
from usmbench.diagnose.naming.stepwise import Named, _trifle, name_causes
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Effect
from usmbench.model.effects.registry import find_effect
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.replay import replay_record
from usmbench.runs.record import Record

LOST = Applied(find_effect("stick_slip", ""), {"lost_rad_s": 0.2, "fades_rad_s": 2.0})


def _of_no_lag(model: HammersteinModel) -> Knowledge:
    """Return what is known of a model whose runs are of a motor without its lag."""
    known = knowledge_of(model)
    lags = np.array([group.startswith("lag") for group in known.features.groups])
    return replace(known, root=np.where(np.diag(lags), 0.02, known.root))


def _stuck(stretches: list[Stretch], model: HammersteinModel, *habits: Applied) -> Problem:
    """Return runs of a rotor that sticks."""
    uses = [s.use for s in stretches]
    noise = np.random.default_rng(1)
    white = [0.01 * noise.standard_normal(s.context.n) for s in stretches]
    known = replace(_of_no_lag(model), habits=tuple(h.to_mapping() for h in habits))
    problem = Problem(stretches, known, estimate_noise(stretches, white, uses), uses)
    problem.residual_rad_s = white
    return _with_residual_of(problem, LOST)


def _with_residual_of(problem: Problem, applied: Applied) -> Problem:
    """Return a problem with the change of an effect in its residual, too."""
    both = copy(problem)
    change = problem.change_rad_s([applied])
    both.residual_rad_s = [r + c for r, c in zip(problem.residual_rad_s, change, strict=True)]
    return both.with_masks(problem.masks)


@pytest.mark.parametrize(
    ("habitual", "p_value", "named"),
    [(False, 1e-6, True), (True, 1e-6, False), (True, 1e-12, True)],
)
def test_what_healthy_runs_show_is_named_only_far_beyond_what_a_day_does(
    stretches: list[Stretch],
    model: HammersteinModel,
    habitual: bool,
    p_value: float,
    named: bool,
) -> None:
    problem = _stuck(stretches, model, *([LOST] if habitual else []))
    left = problem.left([LOST])
    fit = Fit((LOST,), problem.deviance - float(left @ left), 0.0)
    ranked = [Ranked(LOST.effect, fit, fit.statistic, p_value, fit.statistic)]
    found = name_causes(problem, ranked, [LOST.effect], 1.0)
    assert _names(found) == ["stick_slip"] * named


DELAY = Applied(find_effect("transport_delay", ""), {"delay_s": 2e-4})
TWIN: Effect = type("Twin", (type(LOST.effect),), {"name": "twin"})()


@pytest.mark.parametrize(
    ("other", "named"),
    [(TWIN, []), (DELAY.effect, ["transport_delay"])],
    ids=["the same seen through another cause", "another cause beside it"],
)
def test_where_a_habit_leads_another_cause_counts_for_what_it_brings_beside_it(
    stretches: list[Stretch], model: HammersteinModel, other: Effect, named: list[str]
) -> None:
    problem = _stuck(stretches, model, LOST)
    if other is DELAY.effect:
        problem = _with_residual_of(problem, DELAY)
    effects = [LOST.effect, other]
    first, second = rank(problem, effects, 1.0)
    assert (first.effect, second.effect) == (LOST.effect, other)
    assert second.p_value < 1e-4
    # As far beyond what a day does as a habit may be without being news.
    ranked = [replace(first, p_value=1e-6), second]
    # Given the delay the habit is weighed anew.
    assert _names(name_causes(problem, ranked, effects, 1.0))[:1] == named


def test_of_causes_that_explain_as_much_one_that_holds_on_unseen_rows_is_named(
    stretches: list[Stretch], model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = _stuck(stretches, model)
    delay = Applied(find_effect("transport_delay", ""), {"delay_s": 0.001})
    fits = [Fit((applied,), 1000.0, 0.0) for applied in (delay, LOST)]
    ranked = [Ranked(f.effects[0].effect, f, 1000.0, 1e-12, 1000.0) for f in fits]
    effects = [r.effect for r in ranked]
    assert _names(name_causes(problem, ranked, effects, 1.0)) == ["stick_slip"]
    monkeypatch.setattr("usmbench.diagnose.naming.stepwise.nearest", lambda found: found[:1])
    assert _names(name_causes(problem, ranked, effects, 1.0)) == []


def test_what_is_far_out_hides_no_cause_beside_one_that_acts_by_chance(
    stretches: list[Stretch], model: HammersteinModel
) -> None:
    problem = _stuck(stretches, model)
    lost = Applied(
        find_effect("missed_counts", "of the excess"), {"lost_of_excess": 0.5, "above_rad_s": 9.0}
    )
    both = problem.change_rad_s([lost, LOST])
    alone = problem.change_rad_s([LOST])
    for residual, two, one in zip(problem.residual_rad_s, both, alone, strict=True):
        residual += two - one
        slow = np.flatnonzero((np.abs(two - one) == 0.0) & (np.abs(one) > 0.05))
        residual[slow[:: slow.size // 3]] += 2.0
    problem = problem.with_masks([s.use for s in stretches])
    effects = [lost.effect, LOST.effect, find_effect("coupling_backlash", "")]
    ranked = rank(problem, effects, 1.0)
    found = name_causes(problem, ranked, effects, 1.0)
    assert _names(found) == ["missed_counts", "stick_slip"]


@pytest.mark.parametrize("everywhere", [True, False])
def test_a_cause_beside_one_that_acts_by_chance_acts_where_that_one_does_too(
    stretches: list[Stretch], model: HammersteinModel, everywhere: bool
) -> None:
    problem = _stuck(stretches, model)
    lost = Applied(
        find_effect("missed_counts", "of the excess"), {"lost_of_excess": 0.2, "above_rad_s": 7.0}
    )
    lean = Applied(find_effect("gain_asymmetry", "balanced"), {"asymmetry": 0.03})
    parts = zip(stretches, problem.change_rad_s([lost]), problem.change_rad_s([lean]), strict=True)
    noise = np.random.default_rng(2)
    problem.residual_rad_s = [
        0.01 * noise.standard_normal(s.context.n) + one + two * (everywhere | (one == 0.0))
        for s, one, two in parts
    ]
    problem = problem.with_masks([s.use for s in stretches])
    effects = [lost.effect, lean.effect]
    ranked = sorted(rank(problem, effects, 1.0), key=lambda r: r.effect is not lost.effect)
    found = name_causes(problem, ranked, effects, 1.0)
    assert _names(found) == ["missed_counts"] + ["gain_asymmetry"] * everywhere


def _names(found: Named) -> list[str]:
    return [ranking[0].effect.name for ranking in found.rankings]


def _counted(model: HammersteinModel, effects: Sequence[Applied]) -> list[Stretch]:
    """Return a run whose counter, and with it its angle, has gone through effects in turn."""
    phase_deg = np.repeat(np.random.default_rng(4).uniform(-88.0, 88.0, 300), 5)
    n = phase_deg.size
    bare = Record("run", 0.01 * np.arange(1.0, n + 1.0), phase_deg, np.zeros(n), np.full(n, 0.01))
    shaft = replay_record(bare, model).simulation.speed_rad_s
    (plain,), _ = cut_runs([replace(bare, speed_rad_s=shaft)], model, ())
    speed_rad_s = shaft
    for one in effects:
        speed_rad_s = one.effect.apply(speed_rad_s, plain.context, one.values)
    noisy = speed_rad_s + 0.01 * np.random.default_rng(5).standard_normal(n)
    return cut_runs([replace(bare, speed_rad_s=noisy)], model, ())[0]


def test_a_disc_is_seen_at_the_angle_of_the_shaft_where_counts_are_lost(
    model: HammersteinModel,
) -> None:
    disc = Applied(find_effect("encoder_eccentricity", ""), {"cosine": 0.01, "sine": -0.01})
    lost = Applied(
        find_effect("missed_counts", "of the excess"), {"lost_of_excess": 4.0, "above_rad_s": 9.0}
    )
    stretches = _counted(model, [disc, lost])
    uses = [s.use for s in stretches]
    white = [0.01 * np.random.default_rng(6).standard_normal(s.context.n) for s in stretches]
    noise = estimate_noise(stretches, white, uses)
    problem = Problem(stretches, knowledge_of(model), noise, uses)
    effects = [lost.effect, disc.effect, find_effect("phase_quantisation", "rounded")]
    found = name_causes(problem, rank(problem, effects, 1.0), effects, 1.0)
    assert _names(found) == ["missed_counts", "encoder_eccentricity"]
    sizes = next(a.values for a in found.fit.effects if a.effect is disc.effect)
    assert sizes == pytest.approx(disc.values, abs=0.002)


@pytest.mark.parametrize(("drag_rad_s", "trifle"), [(0.05, True), (1.0, False)])
def test_a_third_that_brings_little_is_what_the_forms_of_two_are_off_by(
    drag_rad_s: float, *, trifle: bool
) -> None:
    two = (
        known_motor.applied("gain_asymmetry", "balanced", asymmetry=0.3),
        known_motor.applied("transport_delay", "", delay_s=0.004),
    )
    drag = known_motor.applied("load_torque", "drag", drag_rad_s=drag_rad_s)
    problem = known_motor.problem_of([known_motor.measured(7, *two, drag)])
    found, longer = (Fit(e, problem.drop(e), 0.0) for e in (two, (*two, drag)))
    assert longer.statistic > found.statistic + 100.0
    assert _trifle(Named(problem, [], found, 1.0), longer) == trifle


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (("phase_quantisation", "rounded", {"step_deg": 8.4}), "speed_scale"),
        (("thermal_drift", "speed", {"final_drift": 0.1, "warm_up_s": 20.0}), None),
    ],
    ids=["a grid", "no grid"],
)
def test_beside_a_grid_what_fits_next_is_tried_where_the_best_does_not_hold(
    stretches: list[Stretch],
    model: HammersteinModel,
    monkeypatch: pytest.MonkeyPatch,
    first: tuple[str, str, dict[str, float]],
    second: str | None,
) -> None:
    """What moves a phase fits the rows that it moves over an edge of the grid, and no others."""
    name, form, values = first
    given = Applied(find_effect(name, form), values)
    fit, rankings = Fit((given,), 2e4, 0.0), [[Ranked(given.effect, NOTHING, 2e4, 0.0, 2e4)]]
    found = Named(_stuck(stretches, model), rankings, fit, 1.0)
    beside = [
        Ranked(one.effect, replace(fit, effects=(given, one)), statistic, 1e-20, statistic)
        for one, statistic in (
            (known_motor.applied("phase_scale", "", scale_error=-0.01), 170.0),
            (known_motor.applied("speed_scale", "", scale_error=0.05), 130.0),
        )
    ]
    monkeypatch.setattr(stepwise, "refine_widely", lambda _, fit: fit)
    monkeypatch.setattr(
        stepwise, "worth_a_name", lambda *given: given[2].effects[-1].effect.name == "speed_scale"
    )
    worth = stepwise._first_worth(found, rankings, beside)
    assert (None if worth is None else worth[0][0].effect.name) == second
