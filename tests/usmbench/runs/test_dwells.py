"""Where each window's dwell begins."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from usmbench.runs.dwells import dwell_begin


@given(st.lists(st.sampled_from([-90.0, 0.0, 12.5]), min_size=1, max_size=30))
def test_begins_where_the_phase_took_its_value(phases_deg: list[float]) -> None:
    begin = dwell_begin(np.array(phases_deg))
    for row, first in enumerate(begin):
        assert len(set(phases_deg[first : row + 1])) == 1
        assert first == 0 or phases_deg[first - 1] != phases_deg[first]
