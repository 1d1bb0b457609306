"""Which rows of a run are judged."""

import numpy as np
import pytest

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.model.hammerstein import HammersteinModel
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
    assert len(pieces) == 2
    assert (pieces[0].context.t_s[0], pieces[-1].context.t_s[-1]) == (t_s[0], t_s[-1])
    features = features_of([whole])
    heat = np.array(features.groups) == "heat"
    warmed = np.column_stack(list(features.columns(whole)))[:, heat]
    for piece in pieces:
        rows = np.searchsorted(t_s, piece.context.t_s)[piece.use]
        own = np.column_stack(list(features.columns(piece)))[piece.use][:, heat]
        assert own == pytest.approx(warmed[rows], abs=0.02 * np.max(np.abs(warmed)))
