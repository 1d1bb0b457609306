"""The plans to choose from: each can be driven, and stays where the model is known."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.cutting.check_runs import FEWEST_WINDOWS
from usmbench.diagnose.experiment.experiment_menu import DURATION_S, menu
from usmbench.diagnose.experiment.experiment_range import Range, range_of
from usmbench.diagnose.experiment.proposal import Experiment, planned_record
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

NARROW = Range(-70.0, 83.3, (-5.0, 4.0), 0.01, (41_000.0,), (0.0,))
WIDE = replace(NARROW, frequency_hz=(41_000.0, 41_500.0), torque_nm=(0.0, 0.1, 0.2))


@pytest.fixture
def model() -> HammersteinModel:
    curve = StaticCurve(np.array([-90.0, 0.0, 90.0]), np.array([-9.0, 0.0, 9.0]))
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 80.0), (-4.0, None), 0.04)
    return HammersteinModel(LinearPart(np.array([-0.1]), np.array([0.9]), 0, 0.01), (point,), "x")


def record(frequency_hz: NDArray[np.float64] | None = None) -> Record:
    t_s = 0.01 * np.arange(1.0, 101.0)
    return Record("run", t_s, np.zeros(100), np.zeros(100), np.full(100, 0.01), frequency_hz)


@pytest.mark.parametrize(
    "where",
    [
        NARROW,
        WIDE,
        replace(NARROW, low_deg=10.0, window_s=0.05),
        replace(NARROW, window_s=0.5),
        replace(NARROW, window_s=2.0),
    ],
)
def test_every_plan_is_one_that_sweep_takes_and_stays_in_range(
    where: Range, model: HammersteinModel
) -> None:
    experiments = menu(where)
    assert len({e.says for e in experiments}) == len(experiments)
    for experiment in experiments:
        run = planned_record(experiment.plan, model, where.window_s)
        assert run.phase_deg.min() >= where.low_deg, experiment.says
        assert run.phase_deg.max() <= where.high_deg, experiment.says
        duration_s = float(run.t_s[-1]) / len(experiment.plan.torque_nm)
        # Thirty seconds of long windows would be refused as too few.
        about_s = max(DURATION_S, 6.0 * FEWEST_WINDOWS * where.window_s)
        assert 0.7 * about_s < duration_s < 1.4 * about_s, experiment.says
        changes = np.flatnonzero(np.diff(run.phase_deg))
        assert np.diff(changes).min() >= experiment.hold_windows, experiment.says


def test_the_runs_own_operating_point_comes_first(model: HammersteinModel) -> None:
    points = [replace(model.points[0], frequency_hz=f) for f in (40_000.0, 41_000.0, 42_000.0)]
    where = range_of(replace(model, points=tuple(points)), [record(np.full(100, 41_000.0))])
    assert where is not None
    assert where.frequency_hz[0] == 41_000.0
    driven = [e.plan.frequency_hz for e in menu(where)]
    assert {f[0] for f in driven} == {41_000.0}
    assert {f[1] for f in driven if len(f) == 2} == {40_000.0, 42_000.0}


def test_loads_and_frequencies_are_on_the_menu_only_where_the_model_knows_several() -> None:
    assert len(menu(WIDE)) == len(menu(NARROW)) + 2


def test_an_experiment_can_be_made_longer(model: HammersteinModel) -> None:
    for experiment in menu(NARROW):
        once, thrice = (
            planned_record(e.plan, model, 0.01) for e in (experiment, experiment.repeated(3))
        )
        assert thrice.t_s[-1] == pytest.approx(3.0 * once.t_s[-1], rel=0.01)


def test_the_range_is_the_models(model: HammersteinModel) -> None:
    found = range_of(model, [record()])
    assert found == Range(-90.0, 80.0, (-4.0, 5.0), 0.01, (41_000.0,), (0.0,))


def test_the_frequency_may_come_from_the_runs_or_nowhere(model: HammersteinModel) -> None:
    unknown = replace(model, points=(replace(model.points[0], frequency_hz=None, torque_nm=None),))
    assert range_of(unknown, [record()]) is None
    found = range_of(unknown, [record(), record(np.full(100, 41_300.0))])
    assert found is not None
    assert found.frequency_hz == (41_300.0,)


def test_the_planned_run_does_what_the_model_says(model: HammersteinModel) -> None:
    plan = Experiment(
        "a step",
        {
            "format": "usmbench-plan/1",
            "frequency_hz": 41_000,
            "passes": [{"phase_deg": [0, 60], "direction": "as_listed"}],
            "dwell": {"windows": 20, "extend_to_windows": 20},
        },
    ).plan
    run = planned_record(plan, model, 0.01)
    assert run.phase_deg.tolist() == [0.0] * 20 + [60.0] * 20
    assert run.speed_rad_s[[19, -1]] == pytest.approx([0.0, 6.0], abs=1e-6)
    assert run.t_s[-1] == pytest.approx(0.4)


@pytest.mark.parametrize("window_s", [0.12, 0.15, 0.25, 1.0, 2.0, 5.0])
def test_long_windows_leave_plans_that_sweep_takes(
    window_s: float, model: HammersteinModel
) -> None:
    experiments = menu(replace(NARROW, window_s=window_s))
    assert len(experiments) >= 8
    for experiment in experiments:
        run = planned_record(experiment.plan, model, window_s)
        assert run.phase_deg.min() >= NARROW.low_deg, experiment.says


def test_a_dead_zone_out_of_reach_is_not_swept() -> None:
    says = [e.says for e in menu(replace(NARROW, low_deg=30.0))]
    assert not any("dead zone" in text for text in says)
    assert len(says) == len(menu(NARROW)) - 1
