"""A run that does not say its operating point is at that of the others, if these have one."""

from typing import Any

import numpy as np
import pytest

from usmbench.runs.record import Record
from usmbench.runs.unsaid_points import as_the_others


def _run(name: str, frequency_hz: tuple[float, ...] | None, torque_nm: float | None) -> Record:
    n = 4
    columns: dict[str, Any] = {
        "frequency_hz": None if frequency_hz is None else np.resize(frequency_hz, n),
        "torque_nm": None if torque_nm is None else np.full(n, torque_nm),
    }
    t_s = 0.01 * np.arange(1.0, n + 1.0)
    return Record(name, t_s, np.arange(4.0), np.arange(4.0), np.full(n, 0.01), **columns)


def test_what_is_not_said_is_as_in_the_others() -> None:
    runs = [_run("a", (41e3,), None), _run("b", None, 0.1), _run("c", (41e3,), 0.1)]
    (one, other, third), warnings = as_the_others(runs)
    assert third is runs[2]
    np.testing.assert_array_equal(other.frequency_hz, np.full(4, 41e3))
    np.testing.assert_array_equal(one.torque_nm, np.full(4, 0.1))
    assert warnings == [
        "b: no column frequency_hz: taken for 41000 Hz, as in the others",
        "a: no column torque_nm: taken for 0.1 N·m, as in the others",
    ]


@pytest.mark.parametrize("others", [(41e3, 42e3), (41e3, np.nan)])
def test_where_others_are_at_several_points_it_stays_one_of_its_own(
    others: tuple[float, ...],
) -> None:
    runs = [_run("a", others, None), _run("b", None, None)]
    found, warnings = as_the_others(runs)
    assert found == runs
    (words,) = warnings
    assert "an operating point of its own" in words


def test_runs_that_all_say_nothing_say_enough() -> None:
    runs = [_run("a", None, None), _run("b", None, None)]
    assert as_the_others(runs) == (runs, [])
