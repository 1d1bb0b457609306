"""The inverse map is exact, whatever the knots."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.errors import InputError
from usmbench.identify.paper import KNOTS_BOTH_WAYS_DEG
from usmbench.identify.paper_inverse_map import inverse_de_casteljau
from usmbench.model.bernstein import bezier_value
from usmbench.model.inverse_map import bezier_abscissa


@settings(deadline=None, max_examples=50)
@given(
    st.lists(st.floats(1e-6, 100.0), min_size=1, max_size=30),
    st.floats(-180.0, 180.0),
    st.integers(0, 2**32 - 1),
)
def test_value_of_the_abscissa_is_the_phase(steps: list[float], low: float, seed: int) -> None:
    knots_deg = low + np.concatenate([[0.0], np.cumsum(steps)])
    span = knots_deg[-1] - knots_deg[0]
    phase_deg = np.random.default_rng(seed).uniform(knots_deg[0], knots_deg[-1], 50)
    phase_deg[:2] = knots_deg[0], knots_deg[-1]
    x = bezier_abscissa(phase_deg, knots_deg)
    assert np.all((x >= 0.0) & (x <= 1.0))
    assert np.max(np.abs(bezier_value(x, knots_deg) - phase_deg)) <= 1e-12 * (span + 200.0)


def test_equals_the_papers_iteration() -> None:
    knots_deg = np.array(KNOTS_BOTH_WAYS_DEG)
    phase_deg = np.linspace(-90.0, 90.0, 301)
    rng = np.random.default_rng(0)
    iterated, rounds = inverse_de_casteljau(phase_deg, knots_deg, rng, tolerance_deg=1e-11)
    assert np.max(np.abs(iterated - bezier_abscissa(phase_deg, knots_deg))) < 1e-12
    assert rounds > 100


def test_knots_nearly_on_top_of_each_other_are_solved() -> None:
    knots_deg = np.array([-90.0, -10.0, -10.0 + 1e-9, 10.0, 10.0 + 1e-9, 10.0 + 2e-9, 90.0])
    phase_deg = np.linspace(-90.0, 90.0, 1001)
    x = bezier_abscissa(phase_deg, knots_deg)
    assert np.max(np.abs(bezier_value(x, knots_deg) - phase_deg)) < 1e-11


@pytest.mark.parametrize(
    ("knots_deg", "words"),
    [
        ([0.0], "at least two knots"),
        ([0.0, 10.0, 10.0], "knot 3 .* is not above knot 2"),
        ([0.0, np.nan, 10.0], "finite"),
    ],
)
def test_knots_that_span_no_curve_are_refused(knots_deg: list[float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        bezier_abscissa(np.array([0.0]), np.array(knots_deg))


@pytest.mark.parametrize("phase_deg", [90.1, -90.1, np.nan])
def test_phases_outside_the_knots_are_refused(phase_deg: float) -> None:
    with pytest.raises(InputError, match="outside the knots -90…90°"):
        bezier_abscissa(np.array([0.0, phase_deg]), np.array([-90.0, 0.0, 90.0]))
