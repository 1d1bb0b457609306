"""Where a run that is taken up again goes on, and which of its parts began cold."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from usmbench.runs.pauses import (
    COOLED_S,
    cold_starts,
    resumes_at_s,
    without_pauses_s,
)
from usmbench.runs.record import Record

STARTED = "2026-03-01T10:00:00.000+00:00"
WINDOW_S = 0.01


@pytest.mark.parametrize(
    ("meta", "expected_s"),
    [
        ({"started": STARTED, "resumed": ["2026-03-01T10:01:40.000+00:00"]}, 100.0),
        ({"started": STARTED, "resumed": ["2026-03-01T13:00:00.500+02:00"]}, 3600.5),
        # The clock was set back, or the simulated run is ahead of it.
        ({"started": STARTED, "resumed": ["2026-03-01T09:00:00.000+00:00"]}, 30.01),
        ({"started": STARTED, "resumed": ["2026-03-01T10:00:10.000+00:00"]}, 30.01),
        # Nobody knows.
        ({"started": "yesterday", "resumed": ["2026-03-01T10:01:40.000+00:00"]}, 30.01),
        ({"started": "2026-03-01", "resumed": ["2026-03-01T10:01:40.000+00:00"]}, 30.01),
        ({"started": STARTED, "resumed": []}, 30.01),
        ({}, 30.01),
    ],
)
def test_a_run_goes_on_as_much_later_as_the_wall_clock_says(
    meta: dict[str, Any], expected_s: float
) -> None:
    assert resumes_at_s(30.0, meta, WINDOW_S) == pytest.approx(expected_s)


def test_a_run_without_a_row_begins_when_it_is_taken_up() -> None:
    meta = {"started": STARTED, "resumed": ["2026-03-01T10:01:40.000+00:00"]}
    assert resumes_at_s(0.0, meta, WINDOW_S) == 0.0


def paused(first: int, second: int, pause_s: float) -> Record:
    t_s = WINDOW_S * np.arange(1.0, first + second + 1.0)
    t_s[first:] += pause_s
    column = np.arange(t_s.size, dtype=np.float64)
    record = Record("run", t_s, column, column, np.full(t_s.size, WINDOW_S))
    return replace(record, meta={"id": "a", "motor": "m"}, extra={"mine": column})


def test_a_part_after_an_hour_is_a_run_of_its_own() -> None:
    record = paused(100, 200, COOLED_S)
    first, second = cold_starts(record, 60)
    assert (first.name, second.name) == ("run", "run from 3601 s")
    assert (first.meta.get("id"), second.meta) == ("a", {"motor": "m"})
    assert first.t_s == pytest.approx(record.t_s[:100])
    assert second.t_s == pytest.approx(WINDOW_S * np.arange(1.0, 201.0))
    assert second.phase_deg[0] == 100.0
    assert np.asarray(second.extra["mine"])[0] == 100.0


@pytest.mark.parametrize("first", [30, 100])
def test_what_changed_in_a_run_is_told_by_one_of_its_parts(first: int) -> None:
    record = replace(paused(first, 200, COOLED_S), changed=("windows.csv",))
    told = [part.changed for part in cold_starts(record, 60) if part.changed]
    assert told == [("windows.csv",)]


def test_a_motor_is_not_cold_after_a_minute() -> None:
    record = paused(100, 200, 60.0)
    assert cold_starts(record, 60) == [record]


def test_parts_that_say_nothing_are_left_out_unless_all_do() -> None:
    assert [part.t_s.size for part in cold_starts(paused(30, 200, COOLED_S), 60)] == [200]
    short = paused(30, 40, COOLED_S)
    assert cold_starts(short, 60) == [short]


def test_time_without_pauses_runs_on() -> None:
    record = paused(3, 2, 60.0)
    assert without_pauses_s(record.t_s, WINDOW_S) == pytest.approx(WINDOW_S * np.arange(1.0, 6.0))
