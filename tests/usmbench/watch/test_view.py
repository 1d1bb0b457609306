import json
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.stop_request import request_stop
from usmbench.settings.bench import BenchSettings
from usmbench.settings.bench_file import bench_document
from usmbench.watch.view import LiveView

PLAN = {
    "format": "usmbench-plan/1",
    "name": "short",
    "frequency_hz": 41_000,
    "passes": [{"phase_deg": {"from": -90, "to": 90, "step": 10}}],
}


def seen(view: LiveView, span: str = "whole") -> dict[str, Any]:
    view.look()
    snapshot = view.snapshot(span)
    json.dumps(snapshot, allow_nan=False)
    return snapshot


def test_a_run_is_followed_row_by_row(make_run: Any, line_model: HammersteinModel) -> None:
    run = make_run(plan=PLAN, bench=bench_document(BenchSettings()), firmware="1.0")
    view = LiveView(run.folder, line_model)
    empty = seen(view)
    assert (empty["windows"], empty["now"], empty["trace"]["t_s"]) == (0, {}, [])
    assert empty["state"]["word"] == "measuring"
    run.windows(np.full(30, 45.0))
    run.pair(45.0)
    run.windows(np.full(30, 90.0), speed_rad_s=9.25)
    run.pair(45.0, -1)
    now = seen(view)
    assert now["windows"] == 60
    assert now["planned_windows"] > 100
    assert now["now"]["phase_deg"] == 90.0
    assert now["now"]["temperature_c"] == 25.0
    assert now["now"]["simulated_rad_s"] == pytest.approx(9.0)
    assert now["curve"]["rising"] == {"phase_deg": [45.0], "speed_rad_s": [4.5]}
    assert now["curve"]["falling"]["phase_deg"] == [45.0]
    assert now["model"]["band_rad_s"] == pytest.approx(0.196)
    assert now["model"]["rmse_rad_s"] == pytest.approx(0.25 * 0.5**0.5)
    assert now["trace"]["residual_high_rad_s"][-1] == pytest.approx(0.25)
    assert now["run"]["plan"] == "short"
    assert now["run"]["firmware"] == "1.0"
    run.writer.close("completed")
    ended = seen(view)
    assert ended["state"] == {"word": "completed", "says": "completed", "can_be_stopped": False}
    assert ended["silent_s"] is None


def test_a_pause_is_left_out(make_run: Any) -> None:
    run = make_run()
    view = LiveView(run.folder)
    for times_s in ([0.01, 0.02, 3600.01], [3600.02], [7200.01, 7200.02, 9000.0]):
        for t_s in times_s:
            run.windows(np.array([45.0]), t_s=t_s)
        view.look()
    shown_s = seen(view)["trace"]["t_s"]
    assert shown_s == pytest.approx(0.01 * np.arange(1.0, 8.0))


def test_the_latest_rows_are_shown_finer_where_that_is_wanted(make_run: Any) -> None:
    run = make_run()
    view = LiveView(run.folder)
    run.windows(np.linspace(-90, 90, 5000))
    assert seen(view, "recent")["trace"]["t_s"][0] == pytest.approx(30.04)
    assert seen(view)["trace"]["t_s"][0] < 1.0
    assert seen(view)["model"] is None
    assert seen(view)["planned_windows"] is None


def test_pace_and_time_left_are_by_the_clock_on_the_wall(make_run: Any) -> None:
    run, now_s = make_run(plan=PLAN, bench=bench_document(BenchSettings())), [time.time()]
    view = LiveView(run.folder, clock=lambda: now_s[0])
    for _ in range(20):
        run.windows(np.full(10, 90.0))
        snapshot = seen(view)
        now_s[0] += 0.2
    assert snapshot["windows_per_s"] == pytest.approx(50.0)
    left = snapshot["planned_windows"] - 200
    assert snapshot["left_s"] == pytest.approx(left / 50.0)


def test_silence_is_told_and_so_is_a_stop_that_nobody_takes(make_run: Any) -> None:
    run, late_s = make_run(), [0.0]
    view = LiveView(run.folder, clock=lambda: time.time() + late_s[0])
    run.windows(np.zeros(3))
    late_s[0] = 7.0
    assert "no row for 7 s" in seen(view)["state"]["says"]
    late_s[0] = 0.0
    request_stop(run.folder)
    assert seen(view)["state"]["word"] == "stopping"
    late_s[0] = 3.0
    assert "cut the power" in seen(view)["state"]["says"]


def test_a_bare_file_is_shown_with_pairs_derived_from_it(
    tmp_path: Path, line_model: HammersteinModel
) -> None:
    path = tmp_path / "bare.csv"
    rows = [f"{phase},{phase / 10}" for phase in (-90, -90, -90, 0, 0, 0, 90, 90, 90)]
    path.write_text("phase_deg,speed_rad_s\n" + "\n".join(rows) + "\n")
    snapshot = seen(LiveView(path, line_model))
    assert snapshot["windows"] == 9
    assert snapshot["trace"]["t_s"][-1] == pytest.approx(0.09)
    assert snapshot["curve"]["rising"]["phase_deg"] == [-90.0, 0.0, 90.0]
    assert snapshot["state"]["can_be_stopped"] is False
    assert snapshot["model"]["rmse_rad_s"] == pytest.approx(0.0, abs=1e-9)


def test_what_cannot_be_read_is_said(make_run: Any, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"run\.yaml"):
        LiveView(tmp_path)
    run = make_run()
    view = LiveView(run.folder)
    run.folder.rename(tmp_path / "elsewhere")
    with pytest.raises(InputError, match=r"run\.yaml"):
        view.look()
    (tmp_path / "elsewhere").rename(run.folder)
