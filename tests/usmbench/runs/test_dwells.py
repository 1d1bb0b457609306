"""Where each window's dwell begins, and the pairs of settled dwells."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from usmbench.runs.dwells import derive_pairs, dwell_begin


@given(st.lists(st.sampled_from([-90.0, 0.0, 12.5]), min_size=1, max_size=30))
def test_begins_where_the_phase_took_its_value(phases_deg: list[float]) -> None:
    begin = dwell_begin(np.array(phases_deg))
    for row, first in enumerate(begin):
        assert len(set(phases_deg[first : row + 1])) == 1
        assert first == 0 or phases_deg[first - 1] != phases_deg[first]


def test_any_command_begins_a_dwell() -> None:
    phase_deg, frequency_hz = np.array([5.0, 5.0, 5.0, 9.0]), np.array([41e3, 41e3, 42e3, 42e3])
    assert dwell_begin(phase_deg, frequency_hz).tolist() == [0, 0, 2, 3]


def test_a_dwell_of_a_warm_up_or_without_drive_has_no_pair() -> None:
    phase_deg = np.repeat([90.0, 10.0, 30.0, 30.0, 50.0], 6)
    columns = {
        "sweep": np.repeat([-1.0, 0.0, 0.0, 0.0, 0.0], 6),
        "drive_on": np.repeat([1.0, 1.0, 0.0, 1.0, 1.0], 6),
    }
    pairs = derive_pairs(np.arange(1.0, 31.0), phase_deg, 0.1 * phase_deg, columns)
    assert pairs is not None
    assert pairs.phase_deg.tolist() == [10.0, 30.0, 50.0]
    assert pairs.speed_rad_s.tolist() == [1.0, 3.0, 5.0]
    assert pairs.n_windows.tolist() == [4.0, 4.0, 4.0]
