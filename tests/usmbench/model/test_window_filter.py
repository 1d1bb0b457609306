"""What hangs on a rotor follows its speed between the windows, too."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from usmbench.model.effects.first_order import Lag
from usmbench.model.window_filter import behind_lag, held

Array = NDArray[np.float64]
WINDOW_S, TAU_S = 0.01, 0.0035
HELD_RAD_S = np.repeat([0.0, 5.0, -8.0, 9.0, 3.0], 5)
NATURAL, DAMPING = 2.0 * math.pi / 0.033, 0.07
SWING = np.array([1.0, 2.0 * DAMPING * NATURAL, NATURAL**2])


def shown(delay_s: float, *, sampled: bool) -> tuple[Array, Array]:
    """What windows show of a rotor, and of a disc on a soft shaft behind it."""

    def moved(_: float, x: Array, driven: float) -> Array:
        rotor, disc, rate, _, _ = x
        pull = NATURAL**2 * (rotor - disc) - 2.0 * DAMPING * NATURAL * rate
        return np.array([(driven - rotor) / TAU_S, rate, pull, rotor, disc])

    whole = math.floor(delay_s / WINDOW_S)
    driven_rad_s = np.r_[np.zeros(whole + 1), HELD_RAD_S]
    late_s, x, found = delay_s - whole * WINDOW_S, np.zeros(5), []
    for k in range(HELD_RAD_S.size):
        x[3:] = 0.0
        for driven, lasts_s in (
            (driven_rad_s[k], late_s),
            (driven_rad_s[k + 1], WINDOW_S - late_s),
        ):
            if lasts_s > 0.0:
                solved = solve_ivp(
                    moved, (0.0, lasts_s), x, "DOP853", args=(driven,), rtol=1e-10, atol=1e-10
                )
                x = solved.y[:, -1]
        found.append(x[:2] if sampled else x[3:] / WINDOW_S)
    rotor_rad_s, disc_rad_s = np.transpose(found)
    return rotor_rad_s, disc_rad_s


@pytest.mark.parametrize("sampled", [False, True])
@pytest.mark.parametrize("delay_s", [0.0, 0.0015, 0.0115])
def test_the_rotors_windows_tell_what_drove_it_whenever_it_acted(
    delay_s: float, sampled: bool
) -> None:
    rotor_rad_s, disc_rad_s = shown(delay_s, sampled=sampled)
    behind = behind_lag(SWING[2:], SWING, Lag(TAU_S, delay_s, sampled), WINDOW_S)
    filtered = lfilter(*behind, rotor_rad_s)
    assert filtered == pytest.approx(disc_rad_s, abs=1e-6)
    # If the rotor itself were held through each window, it would be far off.
    as_held = lfilter(*behind_lag(SWING[2:], SWING, Lag(0.0, delay_s), WINDOW_S), rotor_rad_s)
    assert np.max(np.abs(as_held - disc_rad_s)) > 1.0


def test_a_delay_of_most_of_a_window_does_not_make_it_swing_for_ever() -> None:
    rotor_rad_s, disc_rad_s = shown(0.008, sampled=False)
    b, a = behind_lag(SWING[2:], SWING, Lag(TAU_S, 0.008), WINDOW_S)
    assert np.max(np.abs(np.roots(a))) < 1.0
    assert b.sum() / a.sum() == pytest.approx(1.0)
    filtered = lfilter(b, a, rotor_rad_s)
    assert np.max(np.abs(filtered)) < 2.0 * np.max(np.abs(disc_rad_s))


@pytest.mark.parametrize("delay_s", [-1e-20, -0.0005])
@pytest.mark.parametrize("sampled", [False, True])
def test_what_acts_sooner_is_taken_to_act_at_once(delay_s: float, sampled: bool) -> None:
    sooner, at_once = (
        behind_lag(SWING[2:], SWING, Lag(TAU_S, late_s, sampled), WINDOW_S)
        for late_s in (delay_s, 0.0)
    )
    for found, expected in zip(sooner, at_once, strict=True):
        assert found == pytest.approx(expected)


def test_an_input_that_changes_later_counts_later() -> None:
    # An integrator of what is 1 from the last quarter of the first window on.
    step = lfilter(*held(np.array([1.0]), np.array([1.0, 0.0]), 4.0, 3.0), np.ones(2))
    assert step == pytest.approx([0.5 / 4.0, 1.0 + 4.0 / 2.0])
