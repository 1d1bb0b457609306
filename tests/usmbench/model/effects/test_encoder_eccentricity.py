"""An eccentric disc, where the angle is the shaft's and where the disc has counted it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.model.effects.context import Context
from usmbench.model.effects.registry import find_effect
from usmbench.model.hammerstein import LinearPart

SHARE = st.floats(-0.35, 0.35)
OF_SHAFT, OF_DISC, TILTED = (
    find_effect("encoder_eccentricity", form) for form in ("", "by its own counts", "and tilted")
)


@given(cosine=SHARE, sine=SHARE)
def test_a_disc_passes_its_marks_as_fast_as_what_it_counts_grows(
    cosine: float, sine: float
) -> None:
    shaft_rad = np.linspace(-7.0, 7.0, 200)
    values = {"cosine": cosine, "sine": sine}

    def counted_rad(at_rad: np.ndarray) -> np.ndarray:
        return np.asarray(at_rad + cosine * np.sin(at_rad) - sine * np.cos(at_rad))

    step_rad = 1e-5
    growth = (counted_rad(shaft_rad + step_rad) - counted_rad(shaft_rad - step_rad)) / 2e-5
    for form, angle_rad in ((OF_SHAFT, shaft_rad), (OF_DISC, counted_rad(shaft_rad))):
        context = _context(angle_rad)
        ripple = form.apply(np.ones(200), context, values)
        np.testing.assert_allclose(ripple, growth, atol=2e-3)


def test_without_an_angle_both_follow_the_shaft() -> None:
    context, speed = _context(None), np.full(200, 3.0)
    values = {"cosine": 0.2, "sine": 0.1}
    one, other = (form.apply(speed, context, values) for form in (OF_SHAFT, OF_DISC))
    assert other == pytest.approx(one)


def test_a_tilt_adds_a_ripple_twice_a_revolution_that_is_a_share_of_the_first() -> None:
    speed, tilt = np.full(200, 3.0), {"twice_cosine": 0.0, "twice_sine": 0.3}
    turned_rad = 3.0 * 0.01 * (np.arange(200) + 0.5)
    passed = TILTED.apply(speed, _context(None), {"cosine": 0.0, "sine": -0.1, **tilt})
    ripple = -0.1 * np.sin(turned_rad) + 0.03 * np.sin(2.0 * turned_rad)
    assert passed == pytest.approx(3.0 * (1.0 + ripple))
    none = {"cosine": 0.0, "sine": 0.0, **tilt}
    assert TILTED.apply(speed, _context(turned_rad), none) == pytest.approx(speed)


def _context(angle_rad: np.ndarray | None) -> Context:
    linear = LinearPart(np.empty(0), np.array([1.0]), 0, 0.01)
    t_s = 0.01 * np.arange(1.0, 201.0)
    return Context(t_s, 0.01, np.full(200, 8.0), lambda p: p, linear, angle_rad=angle_rad)
