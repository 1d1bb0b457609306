"""The lag with a torque limit is the solution of its differential equation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from usmbench.identify.dynamics import LagFamily
from usmbench.model.effects.base import Context
from usmbench.model.effects.slow_dynamics import SlowDynamics
from usmbench.model.effects.transport_delay import TransportDelay
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import fitted_start_rad_s, free_run
from usmbench.model.torque_limit import limited_run

Array = NDArray[np.float64]

WINDOW_S = 0.01
SETTLED = np.array([3.0, 3.0, -9.0, -9.0, 10.0, 0.0, 0.5, 8.0])
START = -5.0


def by_integration(tau: float, dead: float, slip: float) -> Array:
    """Turn the shaft window by window, time in windows."""

    def target(t: float) -> float:
        return START if t < dead else float(SETTLED[min(int(t - dead), SETTLED.size - 1)])

    def rates(t: float, state: Array) -> Array:
        return np.array([slip / tau * np.tanh((target(t) - state[0]) / slip), state[0]])

    ends = np.arange(SETTLED.size + 1.0)
    solved = solve_ivp(
        rates, (0.0, SETTLED.size), [START, 0.0], t_eval=ends, rtol=1e-8, atol=1e-9, max_step=0.02
    )
    return np.asarray(np.diff(solved.y[1]), dtype=np.float64)


@pytest.mark.parametrize(
    ("tau", "dead", "slip"), [(0.27, 0.08, 8.6), (0.3, 1.4, 3.0), (4.0, 0.5, 1.5)]
)
def test_it_solves_the_equation(tau: float, dead: float, slip: float) -> None:
    run = limited_run(tau, dead, slip, SETTLED, START)
    assert run == pytest.approx(by_integration(tau, dead, slip), abs=2e-3)


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
