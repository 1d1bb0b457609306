"""A soft shaft moves as its differential equation says, averaged over windows."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from known_motor import WINDOW_S, identified, measured
from usmbench.diagnose.pipeline import diagnose
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.linear import time_constant_s

Array = NDArray[np.float64]
ROTOR_RAD_S = np.repeat([5.0, -8.0, 9.0, 3.0, 10.0], 6)
CONTEXT = Context(
    WINDOW_S * np.arange(1.0, ROTOR_RAD_S.size + 1.0),
    WINDOW_S,
    9.0 * ROTOR_RAD_S,
    lambda phase_deg: phase_deg / 9.0,
    first_order(0.0035, 0.0, WINDOW_S),
)
TAU_S = time_constant_s(CONTEXT.linear) or math.nan
SHAPES = pytest.mark.parametrize(("period_s", "damping"), [(0.021, 0.02), (0.05, 0.1), (0.2, 0.7)])


def averages(rates: Callable[[Array, float], list[float]], start: list[float]) -> Array:
    """Solve x′ = rates(x, rotor's speed), the last of x an integral; return its window means."""
    state, means = np.array(start), []
    for speed in ROTOR_RAD_S:

        def held(_: float, x: Array, speed: float = float(speed)) -> Array:
            return np.array(rates(x, speed))

        start_at = np.append(state[:-1], 0.0)
        solved = solve_ivp(held, (0.0, WINDOW_S), start_at, "DOP853", rtol=1e-10, atol=1e-10)
        state = solved.y[:, -1]
        means.append(state[-1] / WINDOW_S)
    return np.array(means)


@SHAPES
def test_the_disc_rings_behind_the_rotor(period_s: float, damping: float) -> None:
    natural = 2.0 * math.pi / period_s

    def rates(x: Array, speed: float) -> list[float]:
        return [x[1], natural**2 * (speed - x[0]) - 2.0 * damping * natural * x[1], x[0]]

    effect = find_effect("shaft_compliance", "")
    disc = effect.apply(ROTOR_RAD_S, CONTEXT, {"period_s": period_s, "damping": damping})
    assert disc == pytest.approx(averages(rates, [ROTOR_RAD_S[0], 0.0, 0.0]), abs=1e-7)


@SHAPES
def test_a_coupling_that_damps_pulls_by_the_difference_of_the_speeds(
    period_s: float, damping: float
) -> None:
    natural = 2.0 * math.pi / period_s

    def rates(x: Array, speed: float) -> list[float]:
        """Twist of the coupling, and speed of the disc."""
        faster = speed - x[1]
        return [faster, natural**2 * x[0] + 2.0 * damping * natural * faster, x[1]]

    effect = find_effect("shaft_compliance", "damped in the coupling")
    disc = effect.apply(ROTOR_RAD_S, CONTEXT, {"period_s": period_s, "damping": damping})
    assert disc == pytest.approx(averages(rates, [0.0, ROTOR_RAD_S[0], 0.0]), abs=1e-7)


def test_a_disc_that_its_coupling_damps_is_named_alone() -> None:
    healthy, period_s, damping, steps = measured(7), 0.085, 0.22, 50
    natural, step_s = 2.0 * math.pi / period_s, WINDOW_S / steps
    disc, twist, seen = float(healthy.speed_rad_s[0]), 0.0, np.empty(healthy.t_s.size)
    for k, rotor in enumerate(healthy.speed_rad_s.tolist()):
        turned_rad = 0.0
        for _ in range(steps):
            twist += step_s * (rotor - disc)
            disc += step_s * (natural**2 * twist + 2.0 * damping * natural * (rotor - disc))
            turned_rad += step_s * disc
        seen[k] = turned_rad / WINDOW_S
    (cause,) = diagnose([replace(healthy, speed_rad_s=seen)], identified()).causes
    assert (cause.name, cause.form) == ("shaft_compliance", "damped in the coupling")
    assert [p.value for p in cause.parameters] == pytest.approx([period_s, damping], rel=0.05)


@SHAPES
def test_a_load_swings_against_the_rotor(period_s: float, damping: float) -> None:
    natural, share = 2.0 * math.pi / period_s, 0.3

    def rates(x: Array, speed: float) -> list[float]:
        """Twist of the coupling, speed of the load, and what the rotor loses to it."""
        twist, load, lost, _ = x
        faster = speed - ROTOR_RAD_S[0] - lost - load
        pull = natural**2 * twist + 2.0 * damping * natural * faster
        return [faster, pull, share * pull - lost / TAU_S, lost]

    effect = find_effect("shaft_compliance", "swinging load")
    shape = {"load_share": share, "period_s": period_s, "damping": damping}
    rotor = effect.apply(ROTOR_RAD_S, CONTEXT, shape)
    lost = averages(rates, [0.0, 0.0, 0.0, 0.0])
    assert np.max(np.abs(lost)) > 0.3
    assert rotor == pytest.approx(ROTOR_RAD_S - lost, abs=1e-7)
