"""What shapes that were tried are worth."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.fitting.shape_ratings import Rated, as_is, matched, peaks

WORTH = st.floats(-1e6, 1e6)


@given(st.lists(WORTH, max_size=30))
def test_peaks_fall_and_are_no_neighbours(worths: list[float]) -> None:
    tried: list[Rated] = [({"at": float(k)}, worth) for k, worth in enumerate(worths)]
    found = peaks(tried)
    assert len(found) <= 10
    assert all(worth > max(50.0, 0.5 * found[0][1]) for _, worth in found[3:])
    assert [worth for _, worth in found] == sorted((w for _, w in found), reverse=True)
    assert all(worth > 0.0 for _, worth in found)
    places = sorted(values["at"] for values, _ in found)
    assert all(b - a > 1.0 for a, b in pairwise(places))
    if max(worths, default=0.0) > 0.0:
        assert found[0][1] == max(worths)


@given(WORTH, st.floats(1e-3, 1e6))
def test_a_smaller_size_takes_away_no_less(drop: float, square: float) -> None:
    assert matched(drop, square) >= as_is(drop, square) - 1e-9 * (abs(drop) + square)
    assert matched(drop, 0.0) == 0.0


@given(st.floats(0.1, 10.0), st.floats(0.1, 1e6))
def test_a_larger_size_is_not_granted(of_true: float, square: float) -> None:
    # A change e c of what is e: it takes away 2 e·ec − (ec)², at most e².
    drop = square * (2.0 * of_true - of_true**2)
    right = square if of_true >= 1.0 else drop
    assert matched(drop, square * of_true**2) == pytest.approx(right, abs=1e-6 * square)
