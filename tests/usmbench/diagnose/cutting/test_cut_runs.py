"""Which rows of a run are judged."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import came_from
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.errors import InputError
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record


def test_rows_that_remember_phases_beyond_the_model_are_not_judged(
    model: HammersteinModel,
) -> None:
    n = 200
    phase_deg = np.full(n, 40.0)
    phase_deg[100] = 120.0
    t_s = 0.01 * np.arange(1.0, n + 1.0)
    speed_rad_s = model.points[0].curve.speed_rad_s(phase_deg)
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(n, 0.01))
    (stretch,), warnings = cut_runs([record], model, ())
    left_out = np.flatnonzero(~stretch.use)
    first, after = left_out[left_out < 100], left_out[left_out >= 100]
    assert first[0] == 0
    assert np.array_equal(after, 100 + np.arange(first.size + 1))  # as long as the start is known
    # Within these a lag of a third of a window is gone.
    assert np.exp(-first.size * 0.01 / 0.0035) == pytest.approx(0.0, abs=1e-3)
    assert "1 rows lie outside" in warnings[0]


def _record(model: HammersteinModel, phase_deg: np.ndarray) -> Record:
    """Return a run of 10 ms windows that follows at once."""
    t_s = 0.01 * np.arange(1.0, phase_deg.size + 1.0)
    speed_rad_s = model.points[0].curve.speed_rad_s(phase_deg)
    return Record("run", t_s, phase_deg, speed_rad_s, np.full(phase_deg.size, 0.01))


def test_rows_without_drive_are_not_judged_nor_those_that_remember_them(
    model: HammersteinModel,
) -> None:
    driven = np.ones(200)
    driven[80:120] = 0.0
    record = replace(_record(model, np.full(200, 40.0)), extra={"drive_on": driven})
    (stretch,), _ = cut_runs([record], model, ())
    left_out = np.flatnonzero(~stretch.use)
    start = np.flatnonzero(left_out < 80).size
    assert np.array_equal(left_out[start:], np.arange(80, 120 + start))


def test_a_frequency_that_changes_while_the_phase_is_held_begins_a_dwell() -> None:
    curve = StaticCurve(np.array([-90.0, 0.0, 90.0]), np.array([-10.0, 0.0, 10.0]))
    half = replace(curve, delta=0.5 * curve.delta)
    points = tuple(
        OperatingPoint(hz, None, c, (-90.0, 90.0), (None, None), 0.02)
        for hz, c in ((41000.0, curve), (41500.0, half))
    )
    model = HammersteinModel(first_order(0.0035, 0.0015, 0.01), points, "fast")
    frequency_hz = np.repeat([41000.0, 41500.0, 41000.0], [70, 60, 70])
    record = replace(_record(model, np.full(200, 45.0)), frequency_hz=frequency_hz)
    (stretch,), _ = cut_runs([record], model, ())
    top_rad_s = curve.speed_rad_s(np.array([45.0]))[0]
    assert np.array_equal(np.flatnonzero(stretch.lag == 0), [0, 70, 130])
    assert stretch.step_rad_s[[69, 70, 129, 130]] == pytest.approx(
        np.array([0.0, -0.5, -0.5, 0.5]) * top_rad_s
    )


def test_pieces_between_many_gaps_are_judged(model: HammersteinModel) -> None:
    phase_deg = np.repeat(np.resize([-60.0, 20.0, 45.0], 100), 10)
    every = _record(model, phase_deg)
    record = every.rows(np.arange(1000) % 50 < 45)
    stretches, _ = cut_runs([record], model, ())
    assert [s.context.n for s in stretches] == 20 * [45]
    assert sum(np.count_nonzero(s.use) for s in stretches) > 0.6 * 1000


def test_rows_a_thousand_windows_apart_may_be_milliseconds(model: HammersteinModel) -> None:
    every = _record(model, np.repeat(np.resize([-60.0, 20.0, 45.0], 20), 10))
    with pytest.raises(InputError, match=r"few.* usable windows .*milliseconds, divide by 1000"):
        cut_runs([replace(every, t_s=1000.0 * every.t_s)], model, ())
    with pytest.raises(InputError, match=r"few.* usable windows .*; measure for longer"):
        cut_runs([replace(every, t_s=100.0 * every.t_s)], model, ())


def test_phases_a_little_beyond_the_model_are_judged(model: HammersteinModel) -> None:
    low_deg, high_deg = model.points[0].phase_range_deg
    ends_deg = [low_deg - 0.009 * (high_deg - low_deg), high_deg + 0.009 * (high_deg - low_deg)]
    phase_deg = np.repeat(np.tile(ends_deg, 5), 20)
    t_s = 0.01 * np.arange(1.0, phase_deg.size + 1.0)
    speed_rad_s = model.points[0].curve.speed_rad_s(phase_deg)
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(phase_deg.size, 0.01))
    _, warnings = cut_runs([record], model, ())
    assert not warnings


def test_a_piece_of_a_long_run_is_as_warm_as_the_run_was(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    n = 6000
    phase_deg = np.repeat(np.random.default_rng(5).uniform(-88.0, 88.0, n // 20), 20)
    phase_deg[: n // 2] *= 0.2  # it stands for long, and warms later
    t_s = 0.01 * np.arange(1.0, n + 1.0)
    speed_rad_s = model.points[0].curve.speed_rad_s(phase_deg)
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(n, 0.01))
    (whole,), _ = cut_runs([record], model, ())
    monkeypatch.setattr("usmbench.diagnose.cutting.cut_runs._MOST_WINDOWS", 4000)
    pieces, _ = cut_runs([record], model, ())
    assert len(pieces) == 4
    assert (pieces[0].context.t_s[0], pieces[-1].context.t_s[-1]) == (t_s[0], t_s[-1])
    features = features_of([whole])
    heat = np.array(features.groups) == "heat"
    warmed = np.column_stack(list(features.columns(whole)))[:, heat]
    for piece in pieces:
        rows = np.searchsorted(t_s, piece.context.t_s)[piece.use]
        own = np.column_stack(list(features.columns(piece)))[piece.use][:, heat]
        assert own == pytest.approx(warmed[rows], abs=0.02 * np.max(np.abs(warmed)))


def test_several_long_runs_leave_no_time_out(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    n = 12_000
    phase_deg = np.repeat(np.random.default_rng(6).uniform(-88.0, 88.0, n // 20), 20)
    t_s, speed_rad_s = 0.01 * np.arange(1.0, n + 1.0), model.points[0].curve.speed_rad_s(phase_deg)
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(n, 0.01))
    runs = [replace(record, meta={"id": k}) for k in range(8)]
    monkeypatch.setattr("usmbench.diagnose.cutting.cut_runs._MOST_WINDOWS", 24_000)
    pieces, _ = cut_runs(runs, model, ())
    assert sum(s.context.n for s in pieces) == pytest.approx(24_000, rel=0.05)
    begins_s = np.sort([s.context.t_s[0] for s in pieces])
    # Three blocks of 10 s in each: together they leave no hole of an eighth of a run.
    assert np.max(np.diff(begins_s)) - 10.0 < t_s[-1] / 8.0
    assert max(s.context.t_s[-1] for s in pieces) == t_s[-1]


@pytest.mark.parametrize("in_one_run", [True, False])
def test_of_many_short_pieces_some_are_judged(
    model: HammersteinModel, monkeypatch: pytest.MonkeyPatch, in_one_run: bool
) -> None:
    monkeypatch.setattr("usmbench.diagnose.cutting.cut_runs._MOST_WINDOWS", 4000)
    n = 400
    phase_deg = np.repeat(np.random.default_rng(5).uniform(-88.0, 88.0, n // 20), 20)
    speed_rad_s = model.points[0].curve.speed_rad_s(phase_deg)
    t_s = 0.01 * np.arange(1.0, n + 1.0)
    if in_one_run:
        t_s = np.concatenate([10.0 * k + t_s for k in range(100)])
        phase_deg, speed_rad_s = np.tile(phase_deg, 100), np.tile(speed_rad_s, 100)
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(t_s.size, 0.01))
    runs = [replace(record, meta={"id": k}) for k in range(1 if in_one_run else 100)]
    stretches, _ = cut_runs(runs, model, ())
    assert 0.8 * 4000 <= sum(s.context.n for s in stretches) <= 1.2 * 4000


def test_what_came_before_is_told_apart_over_stretches(model: HammersteinModel) -> None:
    t_s = 0.01 * np.arange(1.0, 301.0)
    runs = [
        Record("run", t_s, np.repeat(phases_deg, 100), np.ones(300), np.full(300, 0.01))
        for phases_deg in ([30.0, 45.0, 60.0], [50.0, 65.0, 80.0])
    ]
    one, other = (
        came_from(s.settled_rad_s, s.step_rad_s, s.lag) for s in cut_runs(runs, model, ())[0]
    )
    assert np.intersect1d(one, other).size == 0
    assert np.intersect1d(one, one).size == 300
