import tracemalloc
from itertools import islice, pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.settings.bench import BenchSettings
from usmbench.settings.plan import Plan
from usmbench.settings.plan_file import load_plan, parse_plan
from usmbench.settings.yaml_source import Source
from usmbench.sweep.schedule import WARM_UP, Dwell, schedule
from usmbench.sweep.summary import n_dwells, n_windows

WINDOW_S = 0.01


def plan_of(**keys: object) -> Plan:
    document = {"format": "usmbench-plan/1", "frequency_hz": 41000, **keys}
    return parse_plan(Source("plan.yaml", document))


def phases(dwells: list[Dwell]) -> list[float]:
    return [dwell.phase_deg for dwell in dwells]


def test_up_and_down_are_two_passes_with_their_direction() -> None:
    dwells = list(schedule(plan_of(passes=[{"phase_deg": [5, 0, 10], "direction": "both"}]), 0.01))
    assert phases(dwells) == [0, 5, 10, 10, 5, 0]
    assert [dwell.direction for dwell in dwells] == [1, 1, 1, -1, -1, -1]
    assert [dwell.sweep for dwell in dwells] == [0, 0, 0, 1, 1, 1]
    assert [dwell.number for dwell in dwells] == list(range(6))


def test_as_listed_takes_its_direction_from_the_steps() -> None:
    listed = [{"phase_deg": [5, 5, 0, 10, 10, 3], "direction": "as_listed"}]
    dwells = list(schedule(plan_of(passes=listed), 0.01))
    assert phases(dwells) == [5, 5, 0, 10, 10, 3]
    assert [dwell.direction for dwell in dwells] == [1, 1, -1, 1, 1, -1]


def test_operating_points_in_either_order() -> None:
    keys = {
        "frequency_hz": [41000, 42000],
        "torque_nm": [0, 0.1],
        "load": "operator",
        "passes": [{"phase_deg": [0]}],
    }
    outer_torque = [(d.frequency_hz, d.torque_nm) for d in schedule(plan_of(**keys), 0.01)]
    assert outer_torque == [(41000, 0), (42000, 0), (41000, 0.1), (42000, 0.1)]
    keys["outer"] = "frequency_hz"
    outer_frequency = [(d.frequency_hz, d.torque_nm) for d in schedule(plan_of(**keys), 0.01)]
    assert outer_frequency == [(41000, 0), (41000, 0.1), (42000, 0), (42000, 0.1)]


def test_the_warm_up_is_no_dwell_of_the_plan() -> None:
    plan = plan_of(passes=[{"phase_deg": [0]}], warm_up={"phase_deg": 90, "duration_s": 1.5})
    warm_up, first = schedule(plan, WINDOW_S)
    assert (warm_up.number, warm_up.sweep, warm_up.windows) == (WARM_UP, -1, 150)
    assert (warm_up.frequency_hz, warm_up.settle) == (41000, None)
    assert first.number == 0


@pytest.mark.parametrize("name", ["phase-sweep", "operating-points", "telegraph", "multisine"])
@pytest.mark.parametrize("first_dwell", [0, 1, 7])
def test_a_plan_taken_up_later_drives_the_same_dwells(name: str, first_dwell: int) -> None:
    plan = load_plan(name)
    whole = list(schedule(plan, WINDOW_S))
    again = list(schedule(plan, WINDOW_S, first_dwell))
    assert again[1:] == whole[1 + first_dwell :]
    assert (again[0].number, again[0].phase_deg) == (WARM_UP, 90.0)


def test_a_finished_plan_has_nothing_left_not_even_the_warm_up() -> None:
    plan = load_plan("phase-sweep")
    assert list(schedule(plan, WINDOW_S, n_dwells(plan, WINDOW_S))) == []


PASSES = st.lists(
    st.fixed_dictionaries(
        {
            "phase_deg": st.lists(st.integers(-180, 180), min_size=1, max_size=5),
            "direction": st.sampled_from(["rising", "falling", "both", "as_listed"]),
            "repeats": st.integers(1, 3),
        }
    ),
    min_size=1,
    max_size=3,
)


@given(PASSES, st.integers(1, 3), st.integers(1, 3), st.integers(0, 10))
@settings(deadline=None)
def test_what_is_counted_is_what_is_driven(
    passes: list[dict[str, object]], frequencies: int, torques: int, first_dwell: int
) -> None:
    plan = plan_of(
        passes=passes,
        frequency_hz=[41000 + i for i in range(frequencies)],
        torque_nm=[i / 10 for i in range(torques)],
        load="operator",
    )
    dwells = list(schedule(plan, WINDOW_S, first_dwell))
    assert len(dwells) == max(0, n_dwells(plan, WINDOW_S) - first_dwell)
    assert [dwell.number for dwell in dwells] == list(range(first_dwell, first_dwell + len(dwells)))
    assert all(b.sweep - a.sweep in (0, 1) for a, b in pairwise(dwells))
    if first_dwell == 0:
        driven = sum(dwell.windows for dwell in dwells)
        whole = n_windows(plan, BenchSettings().interlocks, WINDOW_S)
        assert whole - driven == n_windows(plan, BenchSettings().interlocks, WINDOW_S, 10**9)


def test_a_long_plan_takes_no_more_memory() -> None:
    day = {"kind": "telegraph", "amplitude_deg": 90, "duration_s": 86400, "hold_windows": 3}
    dwells = schedule(plan_of(excitation=day), WINDOW_S)
    next(dwells)
    tracemalloc.start()
    try:
        for _ in islice(dwells, 20_000):
            pass
        assert tracemalloc.get_traced_memory()[1] < 200_000
    finally:
        tracemalloc.stop()
