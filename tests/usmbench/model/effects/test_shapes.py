"""What some effects do, against figures worked out another way."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from usmbench.model.effects import (
    crystal_error,
    dead_zone_hysteresis,
    encoder_eccentricity,
    speed_scale,
)
from usmbench.model.effects.context import Context
from usmbench.model.effects.coupling_backlash import CouplingBacklash
from usmbench.model.effects.first_order import (
    Lag,
    first_order,
    lag_of,
    net_delay_s,
    true_dead_time_s,
)
from usmbench.model.effects.phase_offset import PhaseOffset
from usmbench.model.effects.phase_quantisation import (
    PhaseCutToZero,
    RoundedPhase,
    TruncatedPhase,
)
from usmbench.model.effects.shaft_compliance import ShaftCompliance, SwingingLoad
from usmbench.model.effects.slow_dynamics import AnotherLag, SlowDynamics
from usmbench.model.effects.transport_delay import TransportDelay
from usmbench.model.extended import Applied, extended_run
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import free_run, time_constant_s

Array = NDArray[np.float64]
WINDOW_S = 0.01
LINEAR = LinearPart(np.array([-0.05]), np.array([0.6, 0.35]), 0, WINDOW_S)


def _context(n: int) -> Context:
    return Context(WINDOW_S * np.arange(1.0, n + 1.0), WINDOW_S, np.zeros(n), lambda p: p, LINEAR)


def test_backlash_swallows_the_gap_after_each_reversal() -> None:
    speed = np.array([1.0, 1.0, -1.0, -1.0, -1.0, 0.0, 1.0, 1.0])
    disc = CouplingBacklash().apply(speed, _context(8), {"gap_rad": 0.015})
    assert np.allclose(disc, [1.0, 1.0, 0.0, -0.5, -1.0, 0.0, 0.0, 0.5])


def test_backlash_swallows_the_gap_in_the_window_in_which_the_shaft_turns_round() -> None:
    settled = np.array([4.0, 4.0, -4.0, -4.0, 4.0, 4.0])
    context = replace(_context(6), phase_deg=settled)
    # The shaft turns on for two fifths of the window before it turns back.
    speed = np.array([4.0, 4.0, -0.8, -4.0, 0.8, 4.0])
    disc = CouplingBacklash().apply(speed, context, {"gap_rad": 0.005})
    assert np.allclose(disc, [4.0, 4.0, -0.3, -4.0, 0.3, 4.0])
    more = CouplingBacklash().apply(speed, context, {"gap_rad": 0.03})
    assert np.allclose(more, [4.0, 4.0, 1.6, -3.4, -1.6, 3.4])


def test_only_a_torque_limit_tells_the_motors_gain_from_the_counters() -> None:
    counter, motor, _contact = speed_scale.FORMS
    plain = _context(4)
    limited = replace(plain, linear=replace(LINEAR, slip_limit_rad_s=5.0))
    assert [counter.untestable([c]) is None for c in (plain, limited)] == [True, True]
    assert [motor.untestable([c]) is None for c in (plain, limited)] == [False, True]
    assert (counter.stage, motor.stage) == ("counter", "settled")


def test_a_contact_at_another_radius_is_another_lever_of_the_same_force() -> None:
    phase_deg = np.repeat([0.0, 4.0, -6.0, 2.0], 6)
    tau_s, slip, ratio = 0.004, 5.0, 1.1
    linear = replace(first_order(tau_s, 0.0, WINDOW_S), slip_limit_rad_s=slip)
    context = replace(_context(24), phase_deg=phase_deg, linear=linear)
    effect = Applied(speed_scale.MovedContact(), {"scale_error": ratio - 1.0})
    speed = extended_run([effect], context).speed_rad_s

    def moved(_: float, state: Array, surface: float) -> Array:
        # Force of the contact over the rotor's inertia, at the healthy radius of 1.
        force = slip / tau_s * math.tanh((surface - state[1] / ratio) / slip)
        return np.array([state[1], force / ratio])

    state, mean = np.zeros(2), np.zeros(24)
    for k, surface in enumerate(phase_deg):
        state[0] = 0.0
        state = solve_ivp(moved, (0.0, WINDOW_S), state, args=(surface,), rtol=1e-8, atol=1e-9).y[
            :, -1
        ]
        mean[k] = state[0] / WINDOW_S
    assert np.allclose(speed, mean, atol=1e-5)


def test_a_register_rounds_or_cuts_off() -> None:
    phase_deg = np.array([-7.4, 0.4, 3.9, 11.0])
    rounded = RoundedPhase().apply(phase_deg, _context(4), {"step_deg": 4.0})
    cut = TruncatedPhase().apply(phase_deg, _context(4), {"step_deg": 4.0})
    assert np.allclose(rounded, [-8.0, 0.0, 4.0, 12.0])
    assert np.allclose(cut, [-8.0, 0.0, 0.0, 8.0])
    to_zero = PhaseCutToZero().apply(np.r_[phase_deg, -8.0], _context(5), {"step_deg": 4.0})
    assert np.allclose(to_zero, [-4.0, 0.0, 0.0, 8.0, -8.0])


@pytest.mark.parametrize("farthest_deg", [47.3, 90.0, 178.9])
def test_steps_are_tried_close_enough_to_meet_a_coarse_one(farthest_deg: float) -> None:
    phase_deg = np.linspace(-farthest_deg, farthest_deg, 101)
    (steps_deg,) = RoundedPhase().grid([replace(_context(101), phase_deg=phase_deg)]).values()
    levels = farthest_deg / steps_deg[steps_deg <= farthest_deg]
    assert np.max(-np.diff(levels[levels < farthest_deg / 10.0])) <= 0.25 + 1e-9
    assert np.max(-np.diff(levels[levels < farthest_deg / 0.4])) <= 0.5 + 1e-9


def test_a_frequency_that_makes_the_motor_faster_never_makes_friction_hold_more() -> None:
    forms = [e for e in crystal_error.FORMS if len(e.parameters) > 1]
    bounds = [(p.low >= 0.0, p.high <= 0.0) for e in forms for p in e.parameters]
    assert bounds == [(True, False), (True, False), (False, True), (False, True)]


def test_a_long_run_has_no_time_for_the_finest_steps() -> None:
    phase_deg = np.random.default_rng(1).uniform(-90.0, 90.0, 10_001)
    context = replace(_context(phase_deg.size), phase_deg=phase_deg)
    few, many = (
        np.count_nonzero(RoundedPhase().grid(contexts)["step_deg"] < 0.69)
        for contexts in ([context], [context, context])
    )
    assert few > 200
    assert many < 15


@pytest.mark.parametrize(
    ("count_rad_s", "finest_deg"), [(None, 0.35), (0.1, 0.35), (0.4, 0.6), (5.0, 0.7)]
)
def test_a_step_worth_no_more_than_a_count_is_lost_among_whole_counts(
    count_rad_s: float | None, finest_deg: float
) -> None:
    """The curve of the context rises by 1 rad/s a degree."""
    phase_deg = np.random.default_rng(1).uniform(-90.0, 90.0, 2000)
    context = replace(_context(2000), phase_deg=phase_deg, count_rad_s=count_rad_s)
    (steps_deg,) = RoundedPhase().grid([context]).values()
    assert np.count_nonzero(steps_deg < finest_deg - 0.01) < 10
    assert np.count_nonzero(steps_deg < finest_deg + 0.02) > 10


def test_what_shifts_the_voltages_acts_behind_the_register() -> None:
    context = replace(_context(50), phase_deg=np.linspace(-40.0, 40.0, 50))
    rounded = Applied(RoundedPhase(), {"step_deg": 5.0})
    late = Applied(PhaseOffset(), {"offset_deg": 2.4})
    runs = [
        extended_run(order, context).speed_rad_s for order in ((rounded, late), (late, rounded))
    ]
    grid_deg = 5.0 * np.rint(context.phase_deg / 5.0)
    truth = extended_run((), replace(context, phase_deg=grid_deg + 2.4)).speed_rad_s
    assert np.array_equal(runs[0], truth)
    assert np.array_equal(runs[1], truth)


@settings(deadline=None, max_examples=30)
@given(tau=st.floats(0.1, 3.0), delay=st.floats(0.0, 3.0))
def test_first_order_is_the_average_of_the_exact_response(tau: float, delay: float) -> None:
    linear = first_order(tau * WINDOW_S, delay * WINDOW_S, WINDOW_S)
    response = free_run(linear, np.ones(12), 0.0)
    fine = (np.arange(12 * 2000) + 0.5) / 2000 - delay
    exact = np.where(fine > 0.0, 1.0 - np.exp(-np.maximum(fine, 0.0) / tau), 0.0)
    assert np.allclose(response, exact.reshape(12, -1).mean(axis=1), atol=1e-3)


@settings(deadline=None, max_examples=30)
@given(tau=st.floats(0.1, 3.0), delay=st.floats(0.0, 3.0))
def test_a_sampled_lag_is_the_exact_response_at_the_ends(tau: float, delay: float) -> None:
    lag = Lag(tau * WINDOW_S, delay * WINDOW_S, sampled=True)
    after = np.arange(1.0, 13.0) - delay
    exact = np.where(after > 0.0, -np.expm1(-np.maximum(after, 0.0) / tau), 0.0)
    assert np.allclose(free_run(lag.linear_part(WINDOW_S), np.ones(12), 0.0), exact, atol=1e-9)


@settings(deadline=None, max_examples=30)
@given(tau=st.floats(0.3, 3.0), delay=st.floats(0.0, 2.9), sampled=st.booleans())
def test_lag_and_delay_come_back(tau: float, delay: float, sampled: bool) -> None:
    linear = Lag(tau * WINDOW_S, delay * WINDOW_S, sampled).linear_part(WINDOW_S)
    found = lag_of(linear, WINDOW_S)
    assert found is not None
    assert math.isclose(found.tau_s, tau * WINDOW_S, rel_tol=1e-6)
    # Sampled late in a window, or averaged without a delay: the two may be the same equation.
    assert np.allclose(
        free_run(found.linear_part(WINDOW_S), np.ones(9), 0.0),
        free_run(linear, np.ones(9), 0.0),
        atol=0.04 if sampled else 1e-9,
    )


@settings(deadline=None, max_examples=30)
@given(tau=st.floats(0.02, 0.15))
def test_a_lag_that_samples_hide_is_no_lag_of_averages(tau: float) -> None:
    # Averages would show it, so that a longer one would change them far more than samples.
    linear = Lag(tau * WINDOW_S, 0.0, sampled=True).linear_part(WINDOW_S)
    found = lag_of(linear, WINDOW_S)
    assert found is not None
    assert found.sampled
    slower = SlowDynamics().linear_part(linear, _context(4), {"added_s": 0.15 * WINDOW_S})
    left = 1.0 - free_run(slower, np.ones(1), 0.0)[0]
    assert math.isclose(left, math.exp(-1.0 / (tau + 0.15)), abs_tol=2e-3)


@settings(deadline=None, max_examples=30)
@given(tau=st.floats(0.3, 3.0), added=st.floats(0.02, 3.0), delay=st.floats(0.0, 1.5))
def test_a_lag_behind_a_lag_is_the_average_of_the_exact_response(
    tau: float, added: float, delay: float
) -> None:
    own = first_order(tau * WINDOW_S, delay * WINDOW_S, WINDOW_S)
    linear = AnotherLag().linear_part(own, _context(4), {"added_s": added * WINDOW_S})
    step_t = 1.0 / 2000
    fine = (np.arange(12 * 2000) + 0.5) * step_t
    first = np.where(fine > delay, -np.expm1(-np.maximum(fine - delay, 0.0) / tau), 0.0)
    kept = math.exp(-step_t / added)
    exact = lfilter([1.0 - kept], [1.0, -kept], first).reshape(12, -1).mean(axis=1)
    assert np.allclose(free_run(linear, np.ones(12), 0.0), exact, atol=2e-3)


def test_no_lag_is_looked_for_behind_a_limited_torque() -> None:
    free = _context(4)
    limited = replace(free, linear=replace(free.linear, slip_limit_rad_s=3.0))
    assert AnotherLag().untestable([free]) is None
    assert "limit" in (AnotherLag().untestable([free, limited]) or "")


def test_a_lag_behind_dynamics_that_are_no_lag_is_that_of_a_straight_input() -> None:
    linear = LinearPart(np.array([-1.2, 0.5]), np.array([0.2, 0.1]), 0, WINDOW_S)
    slower = AnotherLag().linear_part(linear, _context(4), {"added_s": 2.0 * WINDOW_S})
    ramp = 0.5 * np.arange(400.0)
    assert slower.gain == pytest.approx(linear.gain)
    behind = free_run(linear, ramp, 0.0) - free_run(slower, ramp, 0.0)
    assert behind[-1] == pytest.approx(2.0 * 0.5, rel=1e-6)


@settings(deadline=None, max_examples=30)
@given(tau=st.floats(0.02, 3.0))
def test_averages_without_a_delay_are_not_taken_for_samples(tau: float) -> None:
    found = lag_of(Lag(tau * WINDOW_S, 0.0).linear_part(WINDOW_S), WINDOW_S)
    assert found is not None
    assert not found.sampled
    assert math.isclose(found.tau_s, tau * WINDOW_S, rel_tol=1e-6)


def test_a_response_ahead_of_its_time_constant_has_no_dead_time() -> None:
    ahead = LinearPart(np.array([-0.3]), np.array([0.75, -0.05]), 0, WINDOW_S)
    delay_s = net_delay_s(ahead)
    assert delay_s is not None
    assert delay_s < 0.0
    assert true_dead_time_s(ahead) == 0.0


def test_a_whole_window_of_delay_shifts_any_dynamics() -> None:
    linear = LinearPart(np.array([-0.5, 0.3]), np.array([0.5, 0.3]), 0, WINDOW_S)
    late = TransportDelay().linear_part(linear, _context(4), {"delay_s": WINDOW_S})
    steps = np.random.default_rng(1).normal(size=50)
    on_time = free_run(linear, steps, 0.0)
    assert np.allclose(free_run(late, steps, 0.0)[1:], on_time[:-1])


def test_a_soft_shaft_rings_with_its_period_and_settles() -> None:
    step = np.r_[np.zeros(5), np.ones(400)]
    values = {"period_s": 0.2, "damping": 0.05}
    disc = ShaftCompliance().apply(step, _context(step.size), values)
    above = np.flatnonzero(np.diff(np.sign(disc[5:] - 1.0)))
    assert math.isclose(2.0 * WINDOW_S * float(np.mean(np.diff(above))), 0.2, rel_tol=0.05)
    assert math.isclose(disc[-1], 1.0, abs_tol=1e-2)


def test_what_rings_faster_than_two_windows_is_not_told_from_a_ripple() -> None:
    step = np.r_[np.zeros(5), np.ones(40)]
    context = replace(_context(step.size), phase_deg=step)
    for effect in (ShaftCompliance(), SwingingLoad()):
        for period_s, rings in ((0.019, False), (0.021, True)):
            values = {"load_share": 0.3, "period_s": period_s, "damping": 0.05}
            assert bool(np.any(effect.apply(step, context, values) != step)) == rings
        assert effect.grid([context])["period_s"].min() == 0.02


def test_a_load_swings_as_its_equations_of_motion_say() -> None:
    speed = np.repeat([0.0, 5.0, 7.0, -3.0], 10)
    share, period_s, damping = 0.4, 0.06, 0.1
    tau_s, natural = time_constant_s(LINEAR), 2.0 * math.pi / period_s
    assert tau_s is not None

    def moved(_: float, state: Array, unloaded: float) -> Array:
        twist, load, change, _angle = state
        slip = unloaded + change - load
        pull = natural**2 * twist + 2.0 * damping * natural * slip
        return np.array([slip, pull, -change / tau_s - share * pull, unloaded + change])

    state, mean = np.zeros(4), np.zeros(speed.size)
    for k, unloaded in enumerate(speed):
        state[3] = 0.0
        found = solve_ivp(moved, (0.0, WINDOW_S), state, args=(unloaded,), rtol=1e-9, atol=1e-9)
        state = found.y[:, -1]
        mean[k] = state[3] / WINDOW_S
    values = {"load_share": share, "period_s": period_s, "damping": damping}
    loaded = SwingingLoad().apply(speed, replace(_context(40), phase_deg=speed), values)
    assert np.max(np.abs(mean - speed)) > 1.0
    assert np.allclose(loaded, mean, atol=0.03)


def test_a_load_does_not_swing_a_rotor_that_friction_holds() -> None:
    phase_deg = np.repeat([60.0, 5.0, 60.0], 10)
    settled = np.repeat([8.0, 0.0, 8.0], 10)
    context = replace(
        _context(30), phase_deg=phase_deg, settled_rad_s=lambda p: np.where(p > 10.0, 8.0, 0.0)
    )
    values = {"load_share": 0.4, "period_s": 0.06, "damping": 0.1}
    loaded = SwingingLoad().apply(settled, context, values)
    assert np.all(loaded[10:20] == 0.0)
    assert np.max(np.abs(loaded[20:] - 8.0)) > 0.3


def test_a_start_takes_more_on_one_side_at_rest_or_also_on_the_way_through() -> None:
    phase_deg = np.array([0.0, 12.0, 20.0, 12.0, 0.0, -12.0, -20.0, -12.0, 12.0, 20.0])
    settled = np.sign(phase_deg) * np.maximum(np.abs(phase_deg) - 10.0, 0.0)
    context = replace(
        _context(phase_deg.size),
        phase_deg=phase_deg,
        settled_rad_s=lambda p: np.sign(p) * np.maximum(np.abs(p) - 10.0, 0.0),
    )
    stuck = {
        form.form: np.flatnonzero(
            form.apply(settled, context, {"start_later_deg": 5.0}) != settled
        ).tolist()
        for form in dead_zone_hysteresis.FORMS
        if isinstance(form, dead_zone_hysteresis.Sticking)
    }
    assert stuck == {
        "sticking": [1, 5, 8],
        "sticking at rest": [1, 5],
        "sticking forwards": [1, 8],
        "sticking backwards": [5],
    }


def test_a_rotor_sticks_at_the_beginning_of_a_run_and_turns_where_one_is_cut() -> None:
    phase_deg = np.array([12.0, 12.0, 20.0, 12.0])
    settled = phase_deg - 10.0
    begun = replace(
        _context(4), phase_deg=phase_deg, settled_rad_s=lambda p: np.maximum(p - 10.0, 0.0)
    )
    cut = replace(begun, t_s=begun.t_s + 3.0)
    sticking = dead_zone_hysteresis.Sticking()
    shown = [sticking.apply(settled, c, {"start_later_deg": 5.0}) for c in (begun, cut)]
    assert np.allclose(shown, [[0.0, 0.0, 10.0, 2.0], [2.0, 2.0, 10.0, 2.0]])


def test_where_phases_are_few_steps_are_free_down_to_how_far_they_lie_apart() -> None:
    few = replace(_context(31), phase_deg=np.linspace(-90.0, 90.0, 31))
    (tried_deg,) = RoundedPhase().grid([few]).values()
    (one_deg,) = RoundedPhase().grid([replace(few, phase_deg=np.full(31, 5.0))]).values()
    usual = np.isin(tried_deg, one_deg)
    assert np.array_equal(tried_deg[usual], one_deg)
    assert np.min(tried_deg[~usual]) >= 6.0
    assert np.max(-np.diff(90.0 / tried_deg[tried_deg >= 6.0])) <= 0.5 + 1e-9


def test_a_ripple_shows_in_an_arc_that_bends_it() -> None:
    eccentric = encoder_eccentricity.EncoderEccentricity()
    turned = [
        replace(_context(100), angle_rad=np.linspace(0.0, 2.0 * np.pi * turns, 100))
        for turns in (0.05, 0.2)
    ]
    reasons = [eccentric.untestable([c]) for c in turned]
    assert reasons[1] is None
    assert "0.05 times" in str(reasons[0])
