"""A soft shaft moves as its differential equation says, averaged over windows.

The rotor follows held speeds with a lag; the effect sees its means over windows alone.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from known_motor import WINDOW_S
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.hammerstein import LinearPart

Array = NDArray[np.float64]
HELD_RAD_S = np.repeat([5.0, -8.0, 9.0, 3.0, 10.0], 6)
TAU_S, DEAD_TIME_S = 0.0035, 0.0015
CONTEXT = Context(
    WINDOW_S * np.arange(1.0, HELD_RAD_S.size + 1.0),
    WINDOW_S,
    9.0 * HELD_RAD_S,
    lambda phase_deg: phase_deg / 9.0,
    first_order(TAU_S, 0.0, WINDOW_S),
)
SHAPES = pytest.mark.parametrize(("period_s", "damping"), [(0.021, 0.02), (0.05, 0.1), (0.2, 0.7)])


def averages(
    rates: Callable[[Array, float], list[float]], start: list[float]
) -> tuple[Array, Array]:
    """Solve x′ = rates(x, rotor); return the window means of the rotor's speed and of x's last."""
    state, means = np.array([*start, HELD_RAD_S[0], 0.0, 0.0]), []
    for speed in HELD_RAD_S.tolist():

        def moved(_: float, y: Array, speed: float = speed) -> Array:
            *x, rotor, _, _ = y
            return np.array([*rates(np.array(x), rotor), (speed - rotor) / TAU_S, rotor, x[-1]])

        state[-2:] = 0.0
        solved = solve_ivp(moved, (0.0, WINDOW_S), state, "DOP853", rtol=1e-10, atol=1e-10)
        state = solved.y[:, -1]
        means.append(state[-2:] / WINDOW_S)
    rotor_rad_s, last = np.transpose(means)
    return rotor_rad_s, last


@SHAPES
def test_the_disc_rings_behind_the_rotor(period_s: float, damping: float) -> None:
    natural = 2.0 * math.pi / period_s

    def rates(x: Array, rotor: float) -> list[float]:
        """Acceleration of the disc, and its speed."""
        return [natural**2 * (rotor - x[1]) - 2.0 * damping * natural * x[0], x[0]]

    rotor_rad_s, disc_rad_s = averages(rates, [0.0, HELD_RAD_S[0]])
    effect = find_effect("shaft_compliance", "")
    disc = effect.apply(rotor_rad_s, CONTEXT, {"period_s": period_s, "damping": damping})
    assert disc == pytest.approx(disc_rad_s, abs=1e-6)


@SHAPES
def test_a_coupling_that_damps_pulls_by_the_difference_of_the_speeds(
    period_s: float, damping: float
) -> None:
    natural = 2.0 * math.pi / period_s

    def rates(x: Array, rotor: float) -> list[float]:
        """Twist of the coupling, and speed of the disc."""
        faster = rotor - x[1]
        return [faster, natural**2 * x[0] + 2.0 * damping * natural * faster]

    rotor_rad_s, disc_rad_s = averages(rates, [0.0, HELD_RAD_S[0]])
    effect = find_effect("shaft_compliance", "damped in the coupling")
    disc = effect.apply(rotor_rad_s, CONTEXT, {"period_s": period_s, "damping": damping})
    assert disc == pytest.approx(disc_rad_s, abs=1e-6)


@SHAPES
def test_a_load_swings_against_the_rotor(period_s: float, damping: float) -> None:
    natural, share = 2.0 * math.pi / period_s, 0.3

    def rates(x: Array, rotor: float) -> list[float]:
        """Twist of the coupling, speed of the load, and what the rotor loses to it."""
        twist, load, lost = x
        faster = rotor - HELD_RAD_S[0] - lost - load
        pull = natural**2 * twist + 2.0 * damping * natural * faster
        return [faster, pull, share * pull - lost / TAU_S]

    effect = find_effect("shaft_compliance", "swinging load")
    shape = {"load_share": share, "period_s": period_s, "damping": damping}
    unloaded_rad_s, lost_rad_s = averages(rates, [0.0, 0.0, 0.0])
    assert np.max(np.abs(lost_rad_s)) > 0.3
    rotor = effect.apply(unloaded_rad_s, CONTEXT, shape)
    assert rotor == pytest.approx(unloaded_rad_s - lost_rad_s, abs=1e-6)


def test_a_rotor_that_follows_in_two_lags_is_held_through_each_window() -> None:
    two = replace(CONTEXT, linear=LinearPart(np.array([-1.2, 0.4]), np.array([0.2]), 0, WINDOW_S))
    step = np.repeat([0.0, 1.0], 30)
    disc = find_effect("shaft_compliance", "").apply(step, two, {"period_s": 0.5, "damping": 0.3})
    # (1 − cos ω t) of a disc that no damping slows yet, averaged over the first window.
    turned = 2.0 * math.pi * WINDOW_S / 0.5
    assert disc[30] == pytest.approx(1.0 - math.sin(turned) / turned, rel=0.1)
