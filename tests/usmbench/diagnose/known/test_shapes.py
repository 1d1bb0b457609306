"""What the shaft shows of a small change of the settled speed."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.shapes import detuned_rad_s, shown
from usmbench.identify.lag_family import LagFamily
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

WINDOW_S, N, SLIP_RAD_S = 0.01, 600, 6.0
CURVE = StaticCurve(np.array([-90.0, 90.0]), np.array([-10.0, 10.0]))
LAG = LagFamily(1.0).dynamics(np.array([np.log(0.35), 0.15]))


def _stretch(slip_limit_rad_s: float | None) -> Stretch:
    linear = replace(LAG, slip_limit_rad_s=slip_limit_rad_s).linear_part(WINDOW_S)
    point = OperatingPoint(None, None, CURVE, (-90.0, 90.0), (None, None), 0.01)
    phase_deg = np.repeat(np.random.default_rng(5).uniform(-80.0, 80.0, N // 6), 6)
    t_s = WINDOW_S * np.arange(1.0, N + 1.0)
    record = Record("run", t_s, phase_deg, np.zeros(N), np.full(N, WINDOW_S))
    (stretch,), _ = cut_runs([record], HammersteinModel(linear, (point,), "test"), ())
    return stretch


@pytest.mark.parametrize("slip_limit_rad_s", [None, SLIP_RAD_S])
def test_a_small_change_moves_the_run_along_its_shape(slip_limit_rad_s: float | None) -> None:
    stretch = _stretch(slip_limit_rad_s)
    linear, settled = stretch.context.linear, stretch.settled_rad_s
    changes = np.column_stack((settled, np.sin(settled), np.zeros(N)))
    start = float(settled[0])
    moved = [free_run(linear, settled + 1e-5 * c, start) for c in changes.T]
    truth = (np.column_stack(moved) - free_run(linear, settled, start)[:, None]) / 1e-5
    assert shown(stretch, changes) == pytest.approx(truth, abs=1e-3)


def test_a_little_detuning_starts_no_rotor_that_friction_holds() -> None:
    def starting_at(corner_deg: float, frequency_hz: float) -> OperatingPoint:
        nodes_deg = np.linspace(-90.0, 90.0, 121)
        beyond_deg = np.maximum(np.abs(nodes_deg) - corner_deg, 0.0)
        curve = StaticCurve(nodes_deg, np.copysign(0.2 * beyond_deg, nodes_deg))
        return OperatingPoint(frequency_hz, None, curve, (-90.0, 90.0), (None, None), 0.01)

    points = starting_at(45.0, 41000.0), starting_at(25.0, 41025.0)
    phase_deg = np.linspace(-80.0, 80.0, N)
    t_s = WINDOW_S * np.arange(1.0, N + 1.0)
    hz = np.full(N, 41000.0)
    record = Record("run", t_s, phase_deg, np.zeros(N), np.full(N, WINDOW_S), hz)
    model = HammersteinModel(LAG.linear_part(WINDOW_S), points, "test")
    (stretch,), _ = cut_runs([record], model, ())
    moved = detuned_rad_s(stretch)
    held, turns = np.abs(phase_deg) < 20.0, np.abs(phase_deg) > 70.0
    assert np.max(np.abs(moved[held])) < 0.02 * np.min(np.abs(moved[turns]))


def test_a_run_with_a_torque_limit_does_not_grow_in_proportion_to_the_gain() -> None:
    stretch = _stretch(SLIP_RAD_S)
    large = (stretch.lag == 0) & (np.abs(stretch.step_rad_s) > SLIP_RAD_S) & stretch.use
    behind = (shown(stretch, stretch.settled_rad_s) - stretch.simulated_rad_s)[large]
    assert np.all(behind * np.sign(stretch.step_rad_s[large]) < 0.0)
    settled = stretch.use & (stretch.lag > 3)
    again = shown(stretch, stretch.settled_rad_s)[settled]
    assert again == pytest.approx(stretch.simulated_rad_s[settled], abs=0.02)
