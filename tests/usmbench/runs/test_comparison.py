"""Two runs are matched setting by setting, and their run.yaml key by key."""

from typing import Any

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.runs.comparison import compare_pairs, differing_keys
from usmbench.runs.record import Pairs


def pairs(
    rows: list[tuple[float, float, float]], *, frequency_hz: float = 41e3, torque_nm: float = 0.1
) -> Pairs:
    """Pairs of (phase in degrees, direction, speed in rad/s)."""
    phase_deg, direction, speed_rad_s = np.array(rows, dtype=float).T
    n = len(rows)
    return Pairs(
        phase_deg=phase_deg,
        frequency_hz=np.full(n, frequency_hz),
        torque_nm=np.full(n, torque_nm),
        speed_rad_s=speed_rad_s,
        speed_std_rad_s=np.full(n, 0.2),
        n_windows=np.full(n, 4.0),
        direction=direction,
        t_s=np.arange(1.0, n + 1.0),
    )


def test_what_both_have_is_compared_and_nothing_else() -> None:
    first = pairs([(0, 1, 1.0), (10, 1, 2.0), (10, -1, 2.5), (20, 1, 4.0)])
    second = pairs([(10, -1, 3.0), (10.0001, 1, 2.2), (0.01, 1, 9.0)])
    found = compare_pairs(first, second)
    assert found.phase_deg.tolist() == [10.0, 10.0]
    assert found.direction.tolist() == [1.0, -1.0]
    assert found.difference_rad_s == pytest.approx(np.array([0.2, 0.5]))
    assert found.std_rad_s == pytest.approx(np.full(2, np.sqrt(2) * 0.2 / 2))


def test_repeats_are_averaged() -> None:
    first = pairs([(10, 1, 1.0), (10, 1, 3.0)])
    found = compare_pairs(first, pairs([(10, 1, 2.5)]))
    assert found.difference_rad_s.tolist() == [0.5]
    assert found.std_rad_s == pytest.approx(np.sqrt(np.array([0.01 / 2 + 0.01])))


def test_another_operating_point_is_another_setting() -> None:
    with pytest.raises(InputError, match="settled in both runs"):
        compare_pairs(pairs([(10, 1, 1.0)]), pairs([(10, 1, 1.0)], frequency_hz=41.5e3))


def test_an_operating_point_nobody_knows_matches_any() -> None:
    found = compare_pairs(pairs([(10, 1, 1.0)]), pairs([(10, 1, 2.0)], torque_nm=np.nan))
    assert found.difference_rad_s.tolist() == [1.0]
    assert found.frequency_hz.tolist() == [41e3]
    assert np.isnan(found.torque_nm).all()


def test_keys_that_differ_are_named_with_both_values() -> None:
    first = {"id": 1, "seed": 1, "bench": {"daq": {"counter": "ctr0"}, "name": "a"}, "old": [1]}
    second = {"id": 2, "seed": 1, "bench": {"daq": {"counter": "ctr1"}, "name": "a"}}
    assert list(differing_keys(first, second)) == [
        ("bench.daq.counter", "ctr0", "ctr1"),
        ("old", [1], None),
    ]


def test_keys_that_are_no_words_are_compared_like_others() -> None:
    first: dict[Any, Any] = {1: "a", "seed": 1}
    assert list(differing_keys(first, first | {1: "b"})) == [("1", "a", "b")]
