"""Steps of the phase that a scan would miss."""

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.scanning import charged_closely, fit_effect, sharpen
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.model.effects.base import Array, Effect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.parameter import Parameter
from usmbench.model.effects.phase_quantisation import RoundedPhase
from usmbench.model.effects.registry import find_effect, library
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

WINDOW_S, NOISE_RAD_S = 0.01, 0.02
CURVE = StaticCurve(
    np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90]),
    np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4]),
)


def test_a_step_between_two_of_the_grid_is_found_among_random_phases() -> None:
    draw = np.random.default_rng([0, 8])
    phase_deg = np.repeat(draw.uniform(-88.0, 88.0, 300), 5)
    effect = find_effect("phase_quantisation", "rounded")
    # As far from both neighbours as a step can be.
    grid_deg = effect.grid([_at(phase_deg)])["step_deg"]
    k = int(draw.choice(np.flatnonzero((grid_deg > 0.4) & (grid_deg < 6.0))))
    step_deg = float(0.5 * (grid_deg[k] + grid_deg[k + 1]))
    assert _step_found_deg(effect, step_deg, phase_deg, draw) == pytest.approx(step_deg, rel=1e-3)


@pytest.mark.parametrize(
    ("form", "steps_a_level", "levels"),
    [("cut off", 1.53, 45), ("rounded", 2.37, 31), ("cut off", 3.64, 25)],
)
def test_a_grid_is_found_among_levels_farther_apart_and_not_one_that_moves_them_alike(
    form: str, steps_a_level: float, levels: int
) -> None:
    # Those of 0.53, 2.53 or 3.53 steps a level move each level by the same share of a step.
    up_deg = np.linspace(-88.0, 88.0, levels)
    phase_deg = np.repeat(np.r_[up_deg, up_deg[::-1]], 8)
    step_deg = float(up_deg[1] - up_deg[0]) / steps_a_level
    found_deg = _step_found_deg(
        find_effect("phase_quantisation", form), step_deg, phase_deg, np.random.default_rng(levels)
    )
    assert found_deg == pytest.approx(step_deg, rel=5e-3)


def _at(phase_deg: Array) -> Context:
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    linear = first_order(0.0035, 0.0, WINDOW_S)
    return Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, linear)


def _step_found_deg(
    effect: Effect, step_deg: float, phase_deg: Array, draw: np.random.Generator
) -> float:
    point = OperatingPoint(None, None, CURVE, (-90.0, 90.0), (-15.0, 15.0), NOISE_RAD_S)
    context = _at(phase_deg)
    model = HammersteinModel(context.linear, (point,), "fast")
    hidden = Applied(effect, {"step_deg": step_deg})
    noise_rad_s = NOISE_RAD_S * draw.standard_normal(phase_deg.size)
    speed_rad_s = extended_run([hidden], context).speed_rad_s + noise_rad_s
    windows_s = np.full(phase_deg.size, WINDOW_S)
    record = Record("run", context.t_s, phase_deg, speed_rad_s, windows_s)
    (cause,) = diagnose([record], model).causes
    assert cause.name == "phase_quantisation"
    assert cause.form.startswith(effect.form)  # or rounded up, which hardly differs
    return cause.parameters[0].value


@pytest.mark.parametrize("step_deg", [0.12, 0.71, 5.3])
def test_what_is_left_out_of_a_scan_is_not_where_the_step_is(
    step_deg: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    effect = find_effect("phase_quantisation", "cut to zero")
    problem = _showing(Applied(effect, {"step_deg": step_deg}))
    found = fit_effect(problem, effect)
    monkeypatch.setattr("usmbench.diagnose.fitting.shape_search._SIGMAS", np.inf)
    assert found.effects == fit_effect(problem, effect).effects


def test_where_nothing_is_left_steps_that_would_show_plainly_are_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    effect = find_effect("phase_quantisation", "cut to zero")
    problem = _driven(np.repeat(np.random.default_rng(3).uniform(-88.0, 88.0, 120), 5))
    (axis,) = effect.grid([s.context for s in problem.stretches]).values()
    tried: list[Applied] = []
    together = Problem.speeds_rad_s

    def counting(self: Problem, many: Sequence[Sequence[Applied]]) -> Array:
        tried.extend(effects[-1] for effects in many)
        return together(self, many)

    monkeypatch.setattr(Problem, "speeds_rad_s", counting)
    fit_effect(problem, effect)
    assert len(tried) < 0.5 * axis.size


def _showing(hidden: Applied) -> Problem:
    """Return the problem of a run without noise that shows an effect."""
    return _driven(np.repeat(np.random.default_rng(3).uniform(-88.0, 88.0, 120), 5), hidden)


def _driven(phase_deg: Array, *hidden: Applied) -> Problem:
    """Return the problem of a run without noise, driven by some phases."""
    point = OperatingPoint(None, None, CURVE, (-90.0, 90.0), (-15.0, 15.0), NOISE_RAD_S)
    model = HammersteinModel(first_order(0.0035, 0.0, WINDOW_S), (point,), "fast")
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    context = Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, model.linear)
    speed_rad_s = extended_run(hidden, context).speed_rad_s
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(t_s.size, WINDOW_S))
    stretches, _ = cut_runs([record], model, ())
    noise = estimate_noise(stretches, [0.02 * np.sin(t_s)], [s.use for s in stretches])
    return Problem(stretches, knowledge_of(model), noise, [s.use for s in stretches])


@pytest.mark.parametrize("step_deg", [3.21, 4.386, 5.12, 6.47, 7.3])
@pytest.mark.parametrize("off", [-0.07, 0.07])
def test_a_step_some_percent_off_is_put_right_by_a_close_look(step_deg: float, off: float) -> None:
    effect = find_effect("phase_quantisation", "cut to zero")
    problem = _showing(Applied(effect, {"step_deg": step_deg}))
    beside = (Applied(effect, {"step_deg": step_deg * (1.0 + off)}),)
    near = Fit(beside, problem.drop(beside), 0.0)
    closer = sharpen(problem, near, closely=True)
    assert closer.effects[-1].values["step_deg"] == pytest.approx(step_deg, rel=3e-3)
    assert closer.statistic > max(near.statistic, 0.9 * problem.deviance)


class _GridEachWay(RoundedPhase):
    """A grid forwards and another backwards, of which few are tried."""

    form = "each way its own"
    apart = True
    parameters: ClassVar[tuple[Parameter, ...]] = tuple(
        replace(RoundedPhase.parameters[0], name=n) for n in ("ahead", "back")
    )

    def apply(self, signal: Array, context: Context, values: Values) -> Array:
        ahead, back = (
            super(_GridEachWay, self).apply(signal, context, {"step_deg": values[name]})
            for name in ("ahead", "back")
        )
        return np.where(signal > 0.0, ahead, back)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        return {p.name: np.array([1.0, 2.0, 4.0, 8.0]) for p in self.parameters}


def test_a_cause_of_the_users_own_may_be_jagged_and_act_apart_with_a_coarse_grid() -> None:
    effect = _GridEachWay()
    problem = _showing(Applied(effect, {"ahead": 8.0, "back": 4.0}))
    found = sharpen(problem, fit_effect(problem, effect), closely=True).effects[-1]
    assert found.values == pytest.approx({"ahead": 8.0, "back": 4.0}, rel=0.02)


@pytest.mark.parametrize("name", ["transport_delay", "phase_quantisation", "coupling_backlash"])
def test_a_scan_beside_a_cause_that_changes_little_ends_where_one_through_all_does(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    draw = np.random.default_rng(11)
    point = OperatingPoint(None, None, CURVE, (-90.0, 90.0), (-15.0, 15.0), NOISE_RAD_S)
    model = HammersteinModel(first_order(0.0035, 0.0, WINDOW_S), (point,), "fast")
    phase_deg = np.repeat(draw.uniform(-88.0, 88.0, 200), 5)
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    context = Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, model.linear)
    beside = (Applied(find_effect("gain_asymmetry", "balanced"), {"asymmetry": 0.05}),)
    hidden = Applied(find_effect("phase_quantisation", "rounded"), {"step_deg": 5.3})
    speed_rad_s = extended_run([*beside, hidden], context).speed_rad_s
    speed_rad_s += NOISE_RAD_S * draw.standard_normal(t_s.size)
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(t_s.size, WINDOW_S))
    stretches, _ = cut_runs([record], model, ())
    noise = estimate_noise(
        stretches, [speed_rad_s - context.settled_rad_s(phase_deg)], [s.use for s in stretches]
    )
    problem = Problem(stretches, knowledge_of(model), noise, [s.use for s in stretches])
    effect = next(e for e in library() if e.name == name)
    alone = fit_effect(problem, effect, beside)
    monkeypatch.setattr("usmbench.diagnose.fitting.weighed_shapes._SLIGHT", 0.0)
    through_all = fit_effect(problem, effect, beside)
    assert alone.statistic == pytest.approx(through_all.statistic, rel=0.05, abs=2.0)
    assert problem.drop(alone.effects) - problem.drop(beside) == pytest.approx(alone.statistic)


@pytest.mark.parametrize(("delay_s", "low", "high"), [(3e-4, 3.0, 3.0), (0.15, 10.0, np.inf)])
def test_a_small_delay_does_not_pay_for_the_large_ones_that_were_tried(
    delay_s: float, low: float, high: float
) -> None:
    point = OperatingPoint(None, None, CURVE, (-90.0, 90.0), (-15.0, 15.0), NOISE_RAD_S)
    model = HammersteinModel(first_order(0.0035, 0.0, WINDOW_S), (point,), "fast")
    draw = np.random.default_rng(5)
    phase_deg = np.repeat(draw.uniform(-88.0, 88.0, 200), 5)
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    context = Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, model.linear)
    effect = find_effect("transport_delay", "")
    noise_rad_s = NOISE_RAD_S * draw.standard_normal(t_s.size)
    speed_rad_s = extended_run([Applied(effect, {"delay_s": delay_s})], context).speed_rad_s
    record = Record("run", t_s, phase_deg, speed_rad_s + noise_rad_s, np.full(t_s.size, WINDOW_S))
    stretches, _ = cut_runs([record], model, ())
    uses = [s.use for s in stretches]
    noise = estimate_noise(stretches, [noise_rad_s], uses)
    fit = fit_effect(Problem(stretches, knowledge_of(model), noise, uses), effect)
    assert fit.effects[0].values["delay_s"] == pytest.approx(delay_s, rel=0.5)
    assert low <= fit.roughness <= high


@given(
    statistic=st.floats(6.0, 500.0),
    roughness=st.floats(0.0, 100.0),
)
def test_half_of_the_level_is_twice_the_roughness_and_what_the_tail_is_worth(
    statistic: float, roughness: float
) -> None:
    effects = (Applied(find_effect("transport_delay", ""), {"delay_s": 1e-3}),)
    whole = Fit(effects, statistic, roughness).p_value
    assert min(2.0 * whole, 1.0) <= Fit(effects, statistic, 2.0 * roughness + 1.0).p_value


def _multisine_deg(n: int, n_tones: int) -> Array:
    """Return a multisine of two periods, shape (n,)."""
    turned = 4.0 * np.pi / n * np.outer(np.arange(n), np.arange(1, n_tones))
    waves = np.cos(turned + np.random.default_rng(5).uniform(0.0, 2.0 * np.pi, n_tones - 1))
    total = np.sum(waves, axis=1)
    return np.asarray(88.0 * total / np.max(np.abs(total)))


def test_chance_looks_like_a_load_that_rings_as_seldom_as_it_is_charged_for() -> None:
    """Between two periods of the grid lie many that a multisine tells apart."""
    problem = _driven(_multisine_deg(1500, 94))
    effect = find_effect("shaft_compliance", "swinging load")
    found = fit_effect(problem, effect)
    values = found.effects[-1].values
    shapes = [
        {**values, "load_share": 1e-3, "period_s": float(period_s), "damping": float(damping)}
        for period_s in WINDOW_S * np.geomspace(2.0, 30.0, 120)
        for damping in np.geomspace(0.01, 0.8, 8)
    ]
    ways = np.array([problem.carried(problem.change_rad_s([Applied(effect, s)])) for s in shapes])
    ways /= np.maximum(np.linalg.norm(ways, axis=1), 1e-12)[:, None]
    by_chance = np.random.default_rng(6).standard_normal((ways.shape[1], 4000))
    highest = np.max(ways @ by_chance, axis=0) ** 2
    asked = float(np.quantile(highest, 0.99))
    charged = charged_closely(problem, Fit(found.effects, asked, found.roughness))
    assert 0.005 < charged.p_value < 0.03
    assert Fit(found.effects, asked, found.roughness).p_value < 0.005


@pytest.mark.parametrize("name", ["stick_slip", "thermal_drift"])
def test_what_a_grid_already_tries_closely_is_charged_as_it_is(name: str) -> None:
    effect = next(e for e in library() if e.name == name)
    problem = _driven(_multisine_deg(1500, 94))
    found = fit_effect(problem, effect)
    assert charged_closely(problem, found).roughness == pytest.approx(found.roughness, rel=0.02)


def test_a_late_start_is_searched_at_the_phases_that_an_offset_sets() -> None:
    """However little the offset changes the speed, no start is where it was without it."""
    offset = Applied(find_effect("phase_offset", ""), {"offset_deg": -1.5})
    sticks = Applied(
        find_effect("dead_zone_hysteresis", "sticking at rest"), {"start_later_deg": 3.0}
    )
    draw = np.random.default_rng(3)
    near_deg, far_deg = draw.uniform(-30.0, 30.0, 200), draw.uniform(60.0, 88.0, 400)
    dwells_deg = np.repeat(np.r_[near_deg, far_deg], 5)
    problem = _driven(dwells_deg, offset)
    both = problem.measuring(problem.change_rad_s([offset, sticks]))
    all_of_it = both.drop([offset, sticks]) - both.drop([offset])
    assert fit_effect(both, sticks.effect, [offset]).statistic == pytest.approx(all_of_it)
