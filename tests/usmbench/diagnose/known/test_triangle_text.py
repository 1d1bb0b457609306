"""A triangle of numbers goes through text, and anything else is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.diagnose.known.triangle_text import triangle_of, triangle_text


@settings(deadline=None, max_examples=60)
@given(st.integers(1, 12), st.floats(1e-3, 1e4), st.integers(0, 2**32 - 1))
def test_comes_back_to_three_digits(size: int, scale: float, seed: int) -> None:
    matrix = scale * np.tril(np.random.default_rng(seed).uniform(0.1, 1.0, (size, size)))
    again = triangle_of(triangle_text(matrix), size)
    assert again == pytest.approx(matrix, rel=1e-3)
    assert triangle_text(again) == triangle_text(matrix)


def test_what_is_too_large_for_half_precision_is_its_largest() -> None:
    assert triangle_of(triangle_text(np.array([[-1e9]])), 1)[0, 0] == -65504.0


@settings(deadline=None, max_examples=100)
@given(st.text(max_size=40), st.integers(1, 5))
def test_any_other_text_is_a_value_error(text: str, size: int) -> None:
    try:
        matrix = triangle_of(text, size)
    except ValueError:
        return
    assert matrix.shape == (size, size)
    assert np.all(np.isfinite(matrix))


@pytest.mark.parametrize("size", [2, 4])
def test_another_size_is_refused(size: int) -> None:
    with pytest.raises(ValueError, match=f"no triangle of {size} rows"):
        triangle_of(triangle_text(np.eye(3)), size)


def test_what_is_no_number_is_refused() -> None:
    text = triangle_text(np.array([[np.nan]]))
    with pytest.raises(ValueError, match="no triangle"):
        triangle_of(text, 1)
