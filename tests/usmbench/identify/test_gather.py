"""What of a run identification uses, and what it says of the rest."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.identify.gather import from_pairs, from_windows
from usmbench.identify.thinning import searched_part
from usmbench.runs.record import Pairs, Record

Measure = Callable[..., Record]


def test_rest_and_warm_up_are_left_out(measure: Measure) -> None:
    record = measure(300)
    sweep = np.where(record.t_s < 0.505, -1.0, 0.0)
    drive_on = np.where(record.t_s > 2.505, 0.0, 1.0)
    data = from_windows([replace(record, sweep=sweep, extra={"drive_on": drive_on})])
    assert [(s.first_row, s.n) for s in data.segments] == [(50, 200)]
    assert data.runs[0].rows == 200


def test_a_run_that_never_drove_is_refused(measure: Measure) -> None:
    record = replace(measure(300), extra={"drive_on": np.zeros(300)})
    with pytest.raises(InputError, match="no window that was driven"):
        from_windows([record])


def test_the_span_is_that_of_all_rows_also_where_few_are_searched(measure: Measure) -> None:
    record = measure(30_000)
    data = from_windows([record])
    assert searched_part(data, 2000).spans_deg == data.spans_deg
    assert data.spans_deg[0] == (record.phase_deg.min(), record.phase_deg.max())


def test_phases_that_differ_by_rounding_are_one(measure: Measure) -> None:
    levels_deg = np.linspace(-80.0, 80.0, 9)
    phase_deg = np.repeat(np.resize(levels_deg, 30), 10)
    rounded_deg = phase_deg * (1.0 + 1e-14 * np.repeat(np.arange(30.0), 10))
    (segment,) = from_windows([replace(measure(300), phase_deg=rounded_deg)]).segments
    assert np.unique(rounded_deg).size > np.unique(segment.phase_deg).size == 9


def test_a_run_without_pairs_gives_its_driven_windows(measure: Measure) -> None:
    record = measure(300)
    sweep = np.where(record.t_s < 0.505, -1.0, 0.0)
    drive_on = np.where(record.t_s > 2.505, 0.0, 1.0)
    data = from_pairs([replace(record, pairs=None, sweep=sweep, extra={"drive_on": drive_on})])
    assert sum(segment.n for segment in data.segments) == 200


def test_points_of_the_plan_without_a_row_are_named(measure: Measure) -> None:
    plan = {"frequency_hz": [41_000, 41_500], "torque_nm": [0, 0.1]}
    record = replace(measure(300, point=(41_000.0, 0.0)), meta={"id": "x", "plan": plan})
    data = from_windows([record])
    assert "41000 Hz, 0.1 N·m; 41500 Hz, 0 N·m; 41500 Hz, 0.1 N·m" in data.warnings[0]
    assert data.runs[0].id == "x"


def test_a_point_without_a_settled_pair_is_named(measure: Measure) -> None:
    n = 6
    frequency_hz = np.repeat([41_000.0, 42_000.0], 3)
    pairs = Pairs(
        phase_deg=np.tile([0.0, 45.0, 90.0], 2),
        frequency_hz=frequency_hz,
        torque_nm=np.zeros(n),
        speed_rad_s=np.arange(6.0),
        speed_std_rad_s=np.zeros(n),
        n_windows=np.array([5.0, 5, 5, 0, 0, 0]),
        direction=np.ones(n),
        t_s=np.arange(1.0, 7.0),
    )
    plan = {"frequency_hz": [41_000, 42_000]}
    data = from_pairs([replace(measure(300), pairs=pairs, meta={"plan": plan})])
    assert "3 dwells without a settled window left out" in data.warnings[0]
    assert "asks for 42000 Hz, 0 N·m, and no usable row is there" in data.warnings[1]


def test_a_constant_phase_at_one_point_is_refused(measure: Measure) -> None:
    record = measure(300)
    frequency_hz = np.where(record.t_s > 2.505, 42_000.0, 41_000.0)
    phase_deg = np.where(record.t_s > 2.505, 30.0, record.phase_deg)
    with pytest.raises(InputError, match="the phase is 30° throughout at 42000 Hz"):
        from_windows([replace(record, phase_deg=phase_deg, frequency_hz=frequency_hz)])


def test_two_phases_are_refused(measure: Measure) -> None:
    record = measure(300)
    two_deg = np.where(record.phase_deg > 0.0, 90.0, 0.0)
    with pytest.raises(InputError, match=r"the phase is 0° or 90° and never between; .* three"):
        from_windows([replace(record, phase_deg=two_deg)])
    # Together with a run of other phases they are enough.
    assert from_windows([record, replace(record, phase_deg=two_deg)]).spans_deg[0][1] == 90.0


def test_few_windows_are_refused(measure: Measure) -> None:
    assert sum(s.n for s in from_windows([measure(50)]).segments) == 50
    with pytest.raises(InputError, match=r"run 0: only 49 windows were driven; .* need 50"):
        from_windows([measure(49)])


def test_runs_that_do_not_mark_what_was_driven_are_told_of_in_one_line(measure: Measure) -> None:
    unmarked = [measure(300, seed=seed) for seed in (1, 2)]
    marked = replace(measure(300), extra={"drive_on": np.ones(300)})
    passes = replace(measure(300, seed=3), sweep=np.zeros(300))
    assert from_windows([marked, passes]).warnings == ()
    (warning,) = from_windows([marked, *unmarked]).warnings
    assert warning.startswith("run 1 and 1 more: no column drive_on, every row is taken as driven")


def test_runs_of_two_motors_are_refused(measure: Measure) -> None:
    runs = [replace(measure(seed=k), meta={"motor": f"USR60 #{k}"}) for k in (1, 2)]
    with pytest.raises(InputError, match="do not belong together: run 1 is of USR60 #1"):
        from_windows(runs)


def test_a_motor_that_never_moved_is_refused(measure: Measure) -> None:
    still = measure()
    with pytest.raises(InputError, match="the motor never moved"):
        from_windows([replace(still, speed_rad_s=0.0 * still.speed_rad_s)])


def test_a_row_that_no_motor_makes_is_left_out_and_told(measure: Measure) -> None:
    record = measure()
    record.speed_rad_s[200] = 1e6
    data = from_windows([record])
    assert max(float(np.max(np.abs(s.speed_rad_s))) for s in data.segments) < 20.0
    assert data.runs[0].rows == record.t_s.size - 1
    assert any("1 rows are 5 times as fast" in w and "row 200" in w for w in data.warnings)
