"""The widths at which a sticking rotor is looked for."""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.model.effects.base import Effect
from usmbench.model.effects.context import Context
from usmbench.model.effects.dead_zone_hysteresis import FORMS, OutwardEdges, Play
from usmbench.model.effects.sticking import AtRest, Backwards, EachWay, Forwards, Sticking
from usmbench.model.hammerstein import LinearPart, StaticCurve

WINDOW_S = 0.01
KNOTS_DEG = np.linspace(-90.0, 90.0, 91)
# Edges of the dead zone that differ, as those of a real motor do.
BEYOND_DEG = np.maximum(KNOTS_DEG - 13.0, 0.0) + np.minimum(KNOTS_DEG + 14.0, 0.0)
CURVE = StaticCurve(KNOTS_DEG, 9.0 * np.tanh(BEYOND_DEG / 40.0))
LINEAR = LinearPart(np.array([-0.05]), np.array([0.6, 0.35]), 0, WINDOW_S)


def context_of(levels_deg: list[float]) -> Context:
    """Return a staircase up, down and up again."""
    stairs = sorted(levels_deg)
    phase_deg = np.repeat([0.0, *stairs, *stairs[::-1], *stairs], 5)
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    return Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, LINEAR)


@settings(deadline=None, max_examples=50)
@given(
    st.lists(st.integers(-90, 90), min_size=4, max_size=19, unique=True).filter(
        lambda levels: max(map(abs, levels)) > 30
    ),
    st.floats(0.05, 60.0),
    st.sampled_from([Sticking(), AtRest()]),
)
def test_of_a_staircase_every_set_of_starts_is_tried(
    levels_deg: list[int], later_deg: float, effect: Sticking
) -> None:
    context = context_of([float(level) for level in levels_deg])
    settled = context.settled_rad_s(context.phase_deg)
    (tried,) = effect.grid([context]).values()
    wanted = effect.apply(settled, context, {"start_later_deg": later_deg})
    found = [effect.apply(settled, context, {"start_later_deg": float(x)}) for x in tried]
    ends = np.min(np.abs(later_deg - _ends(context))) < 0.02  # where a rounded width may differ
    assert ends or later_deg > tried[-1] or any(np.array_equal(f, wanted) for f in found)


@cache
def _finely() -> tuple[np.ndarray, dict[float, np.ndarray]]:
    fine = np.linspace(0.0, 90.0, 90001)
    return fine, {way: CURVE.speed_rad_s(way * fine) for way in (-1.0, 1.0)}


def _ends(context: Context) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Widths at which a level starts no more, by a search along the curve."""
    fine, settled = _finely()
    least = 0.01 * np.max(np.abs(context.settled_rad_s(context.phase_deg)))
    edges = {way: fine[np.argmax(np.abs(settled[way]) > least)] for way in (-1.0, 1.0)}
    return np.array([abs(p) - edges[1.0 if p > 0 else -1.0] for p in context.phase_deg])


def test_edges_that_move_outward_bound_only_stop_where_they_did() -> None:
    context = context_of([-40.0, -10.0, 20.0, 60.0])
    settled = context.settled_rad_s(context.phase_deg)
    found = OutwardEdges().apply(settled, context, {"width_deg": 6.0})
    at_deg = [0, -34, -10, 14, 54, 54, 20, -10, -34, -34, -10, 14, 54]
    assert found == pytest.approx(np.repeat(CURVE.speed_rad_s(np.array(at_deg, float)), 5))


def test_where_nothing_runs_a_few_widths_are_tried() -> None:
    (tried,) = Sticking().grid([context_of([0.0])]).values()
    assert tried.size == 30
    assert np.all(np.diff(tried) > 0.0)


def test_where_all_starts_are_too_far_out_a_few_widths_are_tried() -> None:
    (tried,) = Sticking().grid([context_of([160.0, 170.0])]).values()
    assert tried.size == 30


@pytest.mark.parametrize("seed", range(5))
def test_of_many_starts_those_that_differ_by_a_fifth_are_told_apart(seed: int) -> None:
    """A multisine may stay at one phase just beyond the edge, and pass quickly at all others."""
    rng = np.random.default_rng([seed, 31])
    turned = 2.0 * np.pi * np.outer(np.arange(1500) / 1500, np.arange(1, 60))
    waves = np.sum(np.cos(turned + rng.uniform(0.0, 2.0 * np.pi, 59)), axis=1)
    phase_deg = np.round(88.0 * waves / np.max(np.abs(waves)), 1)
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    context = Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, LINEAR)
    (tried,) = Sticking().grid([context]).values()
    assert tried.size < 100
    ends = _ends(context)
    stood, seen = 0.0, 0
    for before, end in pairwise(ends):
        stood = max(stood, before) if before > 0.0 else 0.0
        # Widths lie a tenth apart: one at least lies within two of these.
        if stood > 0.5 and 1.21 * stood < end:
            seen += 1
            assert np.any((tried > stood - 0.01) & (tried < end + 0.01))
    assert seen > 20


def test_a_curve_that_dips_below_zero_before_a_jump_starts_at_the_jump() -> None:
    at_deg = [-90.0, -10.0, -9.9, 0.0, 5.0, 8.0, 9.9, 10.0, 90.0]
    speeds_rad_s = [-9.0, -0.6, 0.0, 0.0, -0.3, -0.3, 0.0, 0.6, 9.0]
    context = replace(
        context_of([-60.0, 12.0, 60.0]),
        settled_rad_s=lambda phase_deg: np.interp(phase_deg, at_deg, speeds_rad_s),
    )
    (tried,) = Sticking().grid([context]).values()
    assert tried[0] == pytest.approx(0.5 * (12.0 - 9.915), abs=0.02)


@given(st.floats(-90.0, -15.0), st.floats(0.5, 60.0), st.floats(1.0, 4.0))
def test_a_rotor_does_not_run_where_an_identified_curve_bends_the_wrong_way(
    phase_deg: float, later_deg: float, dip_rad_s: float
) -> None:
    """Beyond the middle of the dead zone a curve that dips there tells nothing of a start."""
    here = np.array([60.0, phase_deg, phase_deg])
    context = Context(WINDOW_S * np.arange(1.0, 4.0), WINDOW_S, here, CURVE.speed_rad_s, LINEAR)
    dips = replace(
        context,
        settled_rad_s=lambda p: (
            CURVE.speed_rad_s(p) - np.where((p > 0.0) & (p < 12.0), dip_rad_s, 0.0)
        ),
    )
    plain_rad_s, dipping_rad_s = (
        Sticking().apply(c.settled_rad_s(here), c, {"start_later_deg": later_deg})[1:]
        for c in (context, dips)
    )
    assert np.array_equal(dipping_rad_s, plain_rad_s)


def test_the_phases_of_several_runs_are_counted_once() -> None:
    context = context_of([float(level) for level in range(-90, 91, 5)])
    one, five = (Sticking().grid([context] * n)["start_later_deg"] for n in (1, 5))
    assert np.array_equal(one, five)


@pytest.mark.parametrize("effect", FORMS, ids=lambda effect: effect.form)
def test_a_motor_that_is_wired_the_other_way_sticks_as_far_out(effect: Effect) -> None:
    context = context_of([-60.0, -25.0, -20.0, 0.0, 20.0, 25.0, 60.0])
    turned = replace(context, settled_rad_s=lambda phase_deg: -CURVE.speed_rad_s(phase_deg))
    values = {p.name: 22.0 for p in effect.parameters}
    # What is backwards for the one is forwards for the other.
    others: dict[type[Effect], Effect] = {Forwards: Backwards(), Backwards: Forwards()}
    other = others.get(type(effect), effect)
    plain = effect.apply(context.settled_rad_s(context.phase_deg), context, values)
    found = other.apply(turned.settled_rad_s(turned.phase_deg), turned, values)
    assert np.max(np.abs(plain - context.settled_rad_s(context.phase_deg))) > 0.1
    assert np.array_equal(found, -plain)


def test_each_way_starts_as_late_as_alone() -> None:
    context = context_of([-60.0, -25.0, -20.0, 0.0, 20.0, 25.0, 60.0])
    settled = context.settled_rad_s(context.phase_deg)
    forwards = Forwards().apply(settled, context, {"start_later_deg": 8.0})
    backwards = Backwards().apply(settled, context, {"start_later_deg": 20.0})
    values = {"forwards_later_deg": 8.0, "backwards_later_deg": 20.0}
    found = EachWay().apply(settled, context, values)
    assert np.array_equal(found, np.where(settled > 0.0, forwards, backwards))
    assert np.any(forwards != settled)
    assert np.any((backwards != settled) & (settled < 0.0))


def _behind_deg(phase_deg: np.ndarray, width_deg: float) -> np.ndarray:
    """Return the phases behind a gap, from the flank of the first move on."""
    first = np.sign(np.diff(phase_deg)[np.flatnonzero(np.diff(phase_deg))[0]])
    found = [float(phase_deg[0] - 0.5 * width_deg * first)]
    for phase in phase_deg[1:].tolist():
        found.append(min(max(found[-1], phase - 0.5 * width_deg), phase + 0.5 * width_deg))
    return np.array(found)


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 9999), st.floats(0.1, 30.0))
def test_a_play_is_that_of_each_window_after_the_other(seed: int, width_deg: float) -> None:
    phase_deg = np.repeat(np.random.default_rng(seed).uniform(-90.0, 90.0, 40), 3)
    context = replace(context_of([0.0]), phase_deg=phase_deg)
    settled = CURVE.speed_rad_s(phase_deg)
    found = Play().apply(settled, context, {"width_deg": width_deg})
    wanted = CURVE.speed_rad_s(_behind_deg(phase_deg, width_deg))
    assert np.allclose(found, wanted, atol=1e-6)
