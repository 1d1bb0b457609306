"""Difference equations against closed forms."""

import numpy as np
import pytest

from usmbench.identify.lag_family import LagFamily
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import (
    dead_time_s,
    delayed,
    fading,
    fitted_start_rad_s,
    free_run,
    from_rest,
    memory_windows,
    time_constant_s,
)

TAU_S, DEAD_S, WINDOW_S = 0.0035, 0.0015, 0.01


def lag(dead_s: float = DEAD_S) -> LinearPart:
    parameters = np.array([np.log(TAU_S / WINDOW_S), dead_s / WINDOW_S])
    return LagFamily(5.0).dynamics(parameters).linear_part(WINDOW_S)


def window_averages(levels: np.ndarray, dead_s: float, fine: int = 2000) -> np.ndarray:
    """Integrate a first-order lag finely and average its speed over each window."""
    step_s = WINDOW_S / fine
    held = np.repeat(levels, fine)
    shift = round(dead_s / step_s)
    held = np.r_[np.full(shift, levels[0]), held[: held.size - shift]]
    decay = np.exp(-step_s / TAU_S)
    # The lag from its steady state, and its exact integral over each fine step.
    speed = np.empty(held.size + 1)
    speed[0] = levels[0]
    for k, level in enumerate(held):
        speed[k + 1] = level + (speed[k] - level) * decay
    integral = held * step_s + (speed[:-1] - held) * TAU_S * (1.0 - decay)
    averages: np.ndarray = integral.reshape(-1, fine).sum(axis=1) / WINDOW_S
    return averages


@pytest.mark.parametrize("dead_s", [0.0, 0.0015, 0.0095, 0.0132])
def test_lag_family_is_the_window_average_of_a_delayed_lag(dead_s: float) -> None:
    levels = np.random.default_rng(0).uniform(-10.0, 10.0, 12)
    wanted = window_averages(levels, dead_s)
    assert np.max(np.abs(free_run(lag(dead_s), levels) - wanted)) < 1e-9


@pytest.mark.parametrize("dead_s", [0.0, 0.0015, 0.0132, 0.0487])
def test_time_constant_and_dead_time_are_read_back(dead_s: float) -> None:
    assert time_constant_s(lag(dead_s)) == pytest.approx(TAU_S, rel=1e-9)
    assert dead_time_s(lag(dead_s)) == pytest.approx(dead_s, abs=1e-12)
    assert lag(dead_s).gain == pytest.approx(1.0, abs=1e-14)


def test_oscillating_poles_have_no_time_constant() -> None:
    linear = LinearPart(np.array([-0.5, 0.8]), np.array([1.3]), 0, WINDOW_S)
    assert time_constant_s(linear) is None
    assert dead_time_s(linear) is None


def test_settled_pairs_have_no_time_constant() -> None:
    linear = LinearPart(np.array([-0.5]), np.array([0.5]), 0, None)
    assert time_constant_s(linear) is None
    assert dead_time_s(linear) is None


def test_a_start_fades_as_the_free_run_forgets_it() -> None:
    settled = np.random.default_rng(1).uniform(-5.0, 5.0, 30)
    linear = lag(0.0132)
    from_four = free_run(linear, settled, 4.0)
    fades = fading(linear.b, linear.a, linear.dead_time_windows, 30)
    rest = from_rest(linear.b, linear.a, linear.dead_time_windows, settled)
    assert np.allclose(from_four, rest + 4.0 * fades, atol=1e-12)
    assert abs(fades[memory_windows(linear)]) < 1e-3


def test_the_start_is_found_from_the_measurement() -> None:
    settled = np.random.default_rng(2).uniform(-5.0, 5.0, 30)
    measured = free_run(lag(), settled, -3.0)
    assert fitted_start_rad_s(lag(), settled, measured) == pytest.approx(-3.0, abs=1e-9)


def test_delay_holds_what_was_before() -> None:
    assert delayed(np.array([1.0, 2.0, 3.0]), 2, 9.0).tolist() == [9.0, 9.0, 1.0]
    assert delayed(np.array([1.0, 2.0]), 5, 9.0).tolist() == [9.0, 9.0]
