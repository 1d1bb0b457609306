"""Identities of the Bernstein basis."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.model.bernstein import bernstein_basis, bezier_slope, bezier_value

DEGREES = st.integers(1, 40)
ABSCISSAS = st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20).map(np.array)


@settings(deadline=None, max_examples=60)
@given(ABSCISSAS, DEGREES)
def test_basis_is_a_partition_of_one(x: np.ndarray, degree: int) -> None:
    basis = bernstein_basis(x, degree)
    assert np.all(basis >= 0.0)
    assert np.allclose(basis.sum(axis=1), 1.0, rtol=0, atol=1e-13)


@settings(deadline=None, max_examples=60)
@given(ABSCISSAS, DEGREES)
def test_recursion_of_equation_6(x: np.ndarray, degree: int) -> None:
    lower = np.pad(bernstein_basis(x, degree), ((0, 0), (1, 1)))
    recursion = (1.0 - x)[:, None] * lower[:, 1:] + x[:, None] * lower[:, :-1]
    assert np.allclose(bernstein_basis(x, degree + 1), recursion, rtol=0, atol=1e-13)


@settings(deadline=None, max_examples=60)
@given(ABSCISSAS, st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=31).map(np.array))
def test_value_without_the_basis_is_the_same(x: np.ndarray, coefficients: np.ndarray) -> None:
    degree = coefficients.size - 1
    wanted = np.full(x.size, coefficients[0])
    if degree:
        wanted = bernstein_basis(x, degree) @ coefficients
    scale = np.max(np.abs(coefficients)) + 1e-300
    assert np.allclose(bezier_value(x, coefficients), wanted, rtol=0, atol=1e-12 * scale)


def test_slope_is_the_derivative() -> None:
    coefficients = np.random.default_rng(0).standard_normal(13)
    x, h = np.linspace(0.01, 0.99, 50), 1e-6
    secant = (bezier_value(x + h, coefficients) - bezier_value(x - h, coefficients)) / (2 * h)
    assert np.allclose(bezier_slope(x, coefficients), secant, atol=1e-6)
