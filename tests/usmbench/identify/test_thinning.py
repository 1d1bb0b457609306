"""A part of a record to search on."""

import tracemalloc
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.identify.data import Dataset, FittedRun, Segment
from usmbench.identify.thinning import searched_part
from usmbench.runs.record import Record

Measure = Callable[..., Record]


def _data(*phases: np.ndarray) -> Dataset:
    segments = tuple(Segment(p, np.zeros(p.size), 0, k, 0) for k, p in enumerate(phases))
    span = (float(min(p.min() for p in phases)), float(max(p.max() for p in phases)))
    run = FittedRun("r", None, sum(p.size for p in phases))
    return Dataset(segments, ((None, None),), 0.01, (run,), (span,))


def test_a_crest_that_is_reached_once_is_searched() -> None:
    # Between the blocks, where an even choice of rows never looks.
    phase_deg = 30.0 * np.sin(np.arange(8000) / 9.0)
    phase_deg[2900:2920] = 90.0
    data = _data(phase_deg, -phase_deg)
    part = searched_part(data, 3000)
    found = np.concatenate([s.phase_deg for s in part.segments])
    assert np.count_nonzero(found == 90.0) >= 8
    assert np.count_nonzero(found == -90.0) >= 8
    assert part.n < 4000


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 999), n=st.integers(50, 6000), most=st.integers(100, 5000))
def test_parts_are_rows_of_the_record_in_order(seed: int, n: int, most: int) -> None:
    rng = np.random.default_rng(seed)
    data = _data(rng.normal(size=n), rng.normal(size=n))
    whole = [s.phase_deg for s in data.segments]
    last = {0: 0, 1: 0}
    for part in searched_part(data, most).segments:
        assert part.first_row >= last[part.run]
        last[part.run] = part.first_row + part.n
        assert np.array_equal(part.phase_deg, whole[part.run][part.first_row :][: part.n])
    assert replace(searched_part(data, most), segments=data.segments) == data


def test_a_long_record_is_thinned_in_little_memory() -> None:
    data = _data(np.linspace(-90.0, 90.0, 1_000_000))
    tracemalloc.start()
    try:
        searched_part(data, 3000)
        assert tracemalloc.get_traced_memory()[1] < 6 * data.n  # bytes; a number a row is eight
    finally:
        tracemalloc.stop()
