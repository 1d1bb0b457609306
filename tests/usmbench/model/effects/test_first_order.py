"""Lags and delays, alone and one behind the other, against exact responses."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.signal import lfilter

from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import (
    Lag,
    first_order,
    lag_of,
    net_delay_s,
    true_dead_time_s,
)
from usmbench.model.effects.slow_dynamics import AnotherLag, SlowDynamics
from usmbench.model.effects.transport_delay import TransportDelay
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import free_run

Array = NDArray[np.float64]
WINDOW_S = 0.01
LINEAR = LinearPart(np.array([-0.05]), np.array([0.6, 0.35]), 0, WINDOW_S)


def _context(n: int) -> Context:
    return Context(WINDOW_S * np.arange(1.0, n + 1.0), WINDOW_S, np.zeros(n), lambda p: p, LINEAR)


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
