"""What shapes that were tried are worth."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.fitting.shape_ratings import Rated, as_is, matched, peaks

WORTH = st.floats(-1e6, 1e6)


@given(st.lists(WORTH, max_size=30))
def test_peaks_fall_and_are_no_neighbours(worths: list[float]) -> None:
    tried: list[Rated] = [({"at": float(k)}, worth) for k, worth in enumerate(worths)]
    found = peaks(tried)
    assert len(found) <= 3
    assert [worth for _, worth in found] == sorted((w for _, w in found), reverse=True)
    assert all(worth > 0.0 for _, worth in found)
    places = sorted(values["at"] for values, _ in found)
    assert all(b - a > 1.0 for a, b in pairwise(places))
    if max(worths, default=0.0) > 0.0:
        assert found[0][1] == max(worths)


@given(WORTH, st.floats(1e-3, 1e6))
def test_a_free_size_takes_away_no_less(drop: float, square: float) -> None:
    assert matched(drop, square) >= as_is(drop, square) - 1e-9 * (abs(drop) + square)
    assert matched(drop, 0.0) == 0.0
