from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel, LinearPart
from usmbench.model.simulate import simulate
from usmbench.watch.beside import Rows, SimulationBeside


def rows_of(phase_deg: NDArray[np.float64]) -> Rows:
    n = len(phase_deg)
    nothing = np.full(n, np.nan)
    t_s = 0.01 * np.arange(1.0, n + 1.0)
    return Rows(t_s, phase_deg, 0.1 * phase_deg, np.full(n, 41_000.0), np.zeros(n), nothing)


def part_of(rows: Rows, part: slice) -> Rows:
    return Rows(**{one.name: getattr(rows, one.name)[part] for one in fields(Rows)})


def test_piece_by_piece_it_says_what_one_simulation_says(line_model: HammersteinModel) -> None:
    slow = replace(line_model, linear=LinearPart(np.array([-0.9]), np.array([0.1]), 1, 0.01))
    phase_deg = np.random.default_rng(2).uniform(-90, 90, 3000)
    rows = rows_of(phase_deg)
    beside = SimulationBeside(slow, 0.01, "run")
    pieces = [beside.simulate(part_of(rows, slice(k, k + 37))) for k in range(0, 3000, 37)]
    whole = simulate(slow, phase_deg, measured_rad_s=rows.speed_rad_s).speed_rad_s
    # What the motor did before the first row is guessed from fewer rows.
    np.testing.assert_allclose(np.concatenate(pieces)[200:], whole[200:], atol=1e-9)


def test_outside_the_models_range_there_is_nothing(line_model: HammersteinModel) -> None:
    speeds = SimulationBeside(line_model, 0.01, "run").simulate(rows_of(np.array([80.0, 100.0])))
    assert speeds[0] == pytest.approx(8.0)
    assert np.isnan(speeds[1])


def test_the_curve_and_the_band_of_a_window(line_model: HammersteinModel) -> None:
    curve = SimulationBeside(line_model, 0.01, "run").curve(41_000.0, float("nan"))
    assert (curve.phase_deg[0], curve.phase_deg[-1]) == (-90.0, 90.0)
    np.testing.assert_allclose(curve.speed_rad_s, curve.phase_deg / 10.0, atol=1e-9)
    assert curve.band_rad_s == pytest.approx(0.196)


def test_windows_of_another_duration_are_refused(line_model: HammersteinModel) -> None:
    with pytest.raises(InputError, match="windows of 20 ms"):
        SimulationBeside(line_model, 0.02, "run")
