"""What some effects do, against figures worked out another way."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from usmbench.model.applied import Applied
from usmbench.model.effects import (
    crystal_error,
    dead_zone_hysteresis,
    encoder_eccentricity,
    speed_scale,
    sticking,
)
from usmbench.model.effects.context import Context
from usmbench.model.effects.coupling_backlash import CouplingBacklash
from usmbench.model.effects.first_order import (
    first_order,
)
from usmbench.model.effects.shaft_compliance import ShaftCompliance, SwingingLoad
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import LinearPart

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


def test_a_frequency_that_makes_the_motor_faster_never_makes_friction_hold_more() -> None:
    forms = [e for e in crystal_error.FORMS if len(e.parameters) > 1]
    bounds = [(p.low >= 0.0, p.high <= 0.0) for e in forms for p in e.parameters]
    assert bounds == [(True, False), (True, False), (False, True), (False, True)]


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
        if isinstance(form, sticking.Sticking) and not form.apart
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
    shown = [sticking.Sticking().apply(settled, c, {"start_later_deg": 5.0}) for c in (begun, cut)]
    assert np.allclose(shown, [[0.0, 0.0, 10.0, 2.0], [2.0, 2.0, 10.0, 2.0]])


def test_a_ripple_shows_in_an_arc_that_bends_it() -> None:
    eccentric = encoder_eccentricity.EncoderEccentricity()
    turned = [
        replace(_context(100), angle_rad=np.linspace(0.0, 2.0 * np.pi * turns, 100))
        for turns in (0.05, 0.2)
    ]
    reasons = [eccentric.untestable([c]) for c in turned]
    assert reasons[1] is None
    assert "0.05 times" in str(reasons[0])
