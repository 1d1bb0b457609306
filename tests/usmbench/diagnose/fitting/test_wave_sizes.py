"""A cosine and a sine are one amplitude at an angle, with intervals that hold the truth."""

import numpy as np
import pytest

from known_motor import applied, measured, problem_of
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine
from usmbench.diagnose.fitting.wave_sizes import polar, wave_sizes
from usmbench.model.effects.parameter import Wave

WAVE = Wave("ripple", "cosine", "sine", "a share")


def test_along_and_across_have_intervals_of_their_own() -> None:
    size, angle = polar(WAVE, "1", np.array([0.0, -0.02]), np.diag([1e-6, 4e-6]))
    assert (size.value, size.low, size.high) == pytest.approx((0.02, 0.018, 0.022))
    half_deg = np.degrees(np.arcsin(0.05))
    assert (angle.value, angle.low, angle.high) == pytest.approx(
        (-90.0, -90.0 - half_deg, -90.0 + half_deg)
    )
    assert (size.name, size.unit, angle.name, angle.unit) == ("ripple", "1", "ripple_at_deg", "deg")


def test_a_wave_that_may_be_none_has_any_angle() -> None:
    size, angle = polar(WAVE, "1", np.array([0.01, 0.0]), np.diag([4e-4, 1e-8]))
    assert size.low == 0.0
    assert angle.high - angle.low == pytest.approx(360.0)


def test_a_disc_off_centre_is_an_amplitude_at_an_angle() -> None:
    disc = applied("encoder_eccentricity", "", cosine=0.012, sine=-0.016)
    delay = applied("transport_delay", "", delay_s=0.003)
    problem = problem_of([measured(5, disc)])
    fit = refine(problem, Fit((disc,), 0.0, 0.0))
    ((size, angle),) = wave_sizes(problem, fit, 1.0)
    assert size.low < 0.02 < size.high < 0.022
    assert angle.low < np.degrees(np.arctan2(-0.016, 0.012)) < angle.high
    both = Fit((delay, *fit.effects), 0.0, 0.0)
    none, beside = wave_sizes(problem, both, 1.0)
    assert none == ()
    assert beside[0].value == size.value
