"""The lag with a torque limit is the solution of its differential equation."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from usmbench.identify.lag_family import LagFamily
from usmbench.model.effects.context import Context
from usmbench.model.effects.slow_dynamics import SlowDynamics
from usmbench.model.effects.transport_delay import TransportDelay
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import fitted_start_rad_s, free_run
from usmbench.model.torque_limit import limited_run, limited_runs

Array = NDArray[np.float64]

WINDOW_S = 0.01
SETTLED = np.array([3.0, 3.0, -9.0, -9.0, 10.0, 0.0, 0.5, 8.0])
START = -5.0


def by_integration(tau: float, dead: float, slip: float, settled: Array = SETTLED) -> Array:
    """Turn the shaft from one change of its target to the next, time in windows."""
    whole, part = int(dead), dead - int(dead)
    late = [START] * (whole + 1) + settled.tolist()
    speed, turned = START, []
    for before, after in pairwise(late[: settled.size + 1]):
        angle = 0.0
        for target, span in ((before, part), (after, 1.0 - part)):
            speed, turn = turned_for(span, target, speed, tau, slip)
            angle += turn
        turned.append(angle)
    return np.array(turned)


def turned_for(
    span: float, target: float, speed: float, tau: float, slip: float
) -> tuple[float, float]:
    """Return the speed after a span of constant target, and the angle turned."""

    def rates(_: float, state: Array) -> Array:
        return np.array([slip / tau * np.tanh((target - state[0]) / slip), state[0]])

    solved = solve_ivp(rates, (0.0, span), [speed, 0.0], "DOP853", rtol=1e-10, atol=1e-10)
    return float(solved.y[0, -1]), float(solved.y[1, -1])


@pytest.mark.parametrize(
    ("tau", "dead", "slip"),
    [(0.27, 0.08, 8.6), (0.3, 1.4, 3.0), (4.0, 0.5, 1.5), (0.3, 0.2, 0.05), (9.0, 2.0, 0.2)],
)
def test_it_solves_the_equation(tau: float, dead: float, slip: float) -> None:
    run = limited_run(tau, dead, slip, SETTLED, START)
    assert run == pytest.approx(by_integration(tau, dead, slip), abs=1e-8)


@settings(deadline=None, max_examples=25)
@given(
    tau=st.floats(0.1, 10.0),
    dead=st.floats(0.0, 3.0),
    slip=st.floats(0.5, 30.0),
    phases=st.lists(st.sampled_from([-9.0, -8.9, 0.0, 0.5, 10.0]), min_size=1, max_size=8),
)
def test_it_solves_the_equation_for_any_motor(
    tau: float, dead: float, slip: float, phases: list[float]
) -> None:
    settled = np.array(phases)
    run = limited_run(tau, dead, slip, settled, START)
    assert run == pytest.approx(by_integration(tau, dead, slip, settled), abs=1e-8)


@pytest.mark.parametrize(("tau", "slip"), [(0.35, 0.1), (4.0, 0.3), (0.01, 0.1)])
def test_changes_of_a_motor_that_hardly_settles_are_told_apart(tau: float, slip: float) -> None:
    settled = np.repeat(np.random.default_rng(7).uniform(-10.0, 10.0, 40), 5)
    run = limited_run(tau, 0.15, slip, settled, START)
    assert run == pytest.approx(by_integration(tau, 0.15, slip, settled), abs=1e-7)


@pytest.mark.parametrize(("tau", "dead"), [(0.27, 0.08), (0.3, 1.4), (9.0, 2.0)])
def test_runs_together_know_nothing_of_each_other(tau: float, dead: float) -> None:
    settled = [SETTLED, SETTLED[:1], np.full(5, 2.0), -SETTLED]
    starts = [START, 4.0, 2.0, -10.0]
    together = limited_runs(tau, dead, 3.0, settled, starts)
    for run, own, start in zip(together, settled, starts, strict=True):
        assert run == pytest.approx(limited_run(tau, dead, 3.0, own, start), abs=1e-12)


@pytest.mark.parametrize("slip", [0.2, 1e-3, 1e-6])
def test_a_saturated_motor_speeds_up_steadily(slip: float) -> None:
    run = limited_run(slip, 0.0, slip, np.full(20, 100.0), 0.0)  # s/τ = 1 rad/s a window
    assert run == pytest.approx(np.arange(20) + 0.5, abs=1e-9)


@settings(deadline=None, max_examples=25)
@given(
    tau=st.floats(0.05, 5.0),
    dead=st.floats(0.0, 3.0),
    phases=st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=40),
)
def test_without_a_limit_to_speak_of_it_is_the_lag(
    tau: float, dead: float, phases: list[float]
) -> None:
    settled = np.array(phases)
    linear = LagFamily(9.0).dynamics(np.array([np.log(tau), dead])).linear_part(WINDOW_S)
    run = limited_run(tau, dead, 1e5, settled, 1.0)
    assert run == pytest.approx(free_run(linear, settled, 1.0), abs=1e-4)


def limited(tau: float, dead: float, slip: float | None) -> LinearPart:
    dynamics = LagFamily(9.0).dynamics(np.array([np.log(tau), dead]))
    part = dynamics.linear_part(WINDOW_S)
    return LinearPart(part.a, part.b, part.dead_time_windows, WINDOW_S, slip)


def test_the_start_is_found_through_the_limit() -> None:
    linear = limited(0.5, 0.2, 2.0)
    speed = free_run(linear, SETTLED, 9.0)
    assert fitted_start_rad_s(linear, SETTLED, speed) == pytest.approx(9.0, abs=1e-4)


@pytest.mark.parametrize(
    ("effect", "values", "tau", "dead"),
    [
        (SlowDynamics(), {"added_s": 0.003}, 0.6, 0.2),
        (TransportDelay(), {"delay_s": 0.012}, 0.3, 1.4),
    ],
)
def test_causes_that_change_the_lag_keep_the_limit(
    effect: SlowDynamics | TransportDelay, values: dict[str, float], tau: float, dead: float
) -> None:
    context = Context(np.ones(1), WINDOW_S, np.ones(1), lambda phase: phase, limited(0.3, 0.2, 8.0))
    changed = effect.linear_part(context.linear, context, values)
    assert free_run(changed, SETTLED, START) == pytest.approx(
        limited_run(tau, dead, 8.0, SETTLED, START), abs=1e-9
    )
