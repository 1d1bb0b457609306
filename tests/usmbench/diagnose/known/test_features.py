"""The shapes that a model may leave."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.known.step_columns import after_steps
from usmbench.diagnose.noise.noise_model import LAGS
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.model.polygon import hats
from usmbench.runs.record import Record


def test_a_curve_that_is_off_shows_as_the_linear_part_lets_it(stretches: list[Stretch]) -> None:
    (stretch,) = stretches
    features = features_of(stretches)
    off = np.column_stack(list(hats(stretch.context.phase_deg, np.array(features.nodes_deg))))
    driven = np.flatnonzero(off[stretch.use].sum(axis=0) > 3.0)
    columns = np.column_stack(list(features.columns(stretch)))
    linear, settled, used = stretch.context.linear, stretch.settled_rad_s, stretch.use
    assert driven.size > 20
    for k in driven:
        change = free_run(linear, settled + off[:, k]) - free_run(linear, settled)
        assert np.max(np.abs(off[:, k] - change)[used]) > 0.1  # a step shows but part of it
        assert columns[used, k] == pytest.approx(change[used], abs=2e-3)


@pytest.mark.parametrize("hold", [1, 3, 8])
def test_a_step_has_its_course_though_another_comes_meanwhile(
    model: HammersteinModel, hold: int
) -> None:
    phase_deg = np.repeat(np.random.default_rng(hold).uniform(-88.0, 88.0, 200 // hold), hold)
    n = phase_deg.size
    t_s, settled = 0.01 * np.arange(1.0, n + 1.0), model.points[0].curve.speed_rad_s(phase_deg)
    ((stretch,), _) = cut_runs(
        [Record("run", t_s, phase_deg, settled, np.full(n, 0.01))], model, ()
    )
    features = features_of([stretch])
    columns = np.column_stack(list(features.columns(stretch)))
    steps, groups = np.diff(settled, prepend=settled[0]), np.array(features.groups)
    for lag in range(LAGS):
        course = columns[:, groups == f"lag {lag}"].sum(axis=1)
        assert course[lag:] == pytest.approx(steps[: n - lag], abs=1e-5)


def test_lateness_has_a_shape_of_its_own_where_the_dynamics_outlast_the_lags(
    model: HammersteinModel,
) -> None:
    """Of a motor that takes many windows for a step, what comes after the last lag is in none."""
    window_s, n = 0.002, 600
    linear = first_order(0.008, 0.001, window_s)
    quick = replace(model, linear=linear)
    phase_deg = np.repeat(np.random.default_rng(4).choice([-80.0, 0.0, 80.0], n // 2), 2)
    settled = model.points[0].curve.speed_rad_s(phase_deg)
    late_rad_s = free_run(first_order(0.008, 0.00102, window_s), settled)
    record = Record(
        "run", window_s * np.arange(1.0, n + 1.0), phase_deg, late_rad_s, np.full(n, window_s)
    )
    ((stretch,), _) = cut_runs([record], quick, ())
    features = features_of([stretch])
    columns, groups = np.column_stack(list(features.columns(stretch))), np.array(features.groups)
    use = stretch.use
    cells = columns[use][:, np.char.startswith(groups, "lag")]
    residual = stretch.residual_rad_s[use]
    by_cells = residual - cells @ np.linalg.lstsq(cells, residual, rcond=None)[0]
    (lateness,) = columns[use][:, groups == "late"].T
    by_lateness = residual - lateness * float(lateness @ residual) / float(lateness @ lateness)
    assert np.linalg.norm(by_lateness) < 0.1 * np.linalg.norm(by_cells)


@pytest.mark.parametrize("n", range(1, LAGS + 2))
def test_a_stretch_may_be_shorter_than_a_course(stretches: list[Stretch], n: int) -> None:
    """Of a very long run a piece between two breaks is kept however few windows it has."""
    (whole,) = stretches
    short = replace(
        whole,
        settled_rad_s=whole.settled_rad_s[:n],
        step_rad_s=whole.step_rad_s[:n],
        lag=whole.lag[:n],
    )
    assert {column.shape for column in after_steps(short, 10.0)} == {(n,)}
