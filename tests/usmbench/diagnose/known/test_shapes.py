"""What the shaft shows of a small change of the settled speed."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.gaps import Gaps
from usmbench.diagnose.known.shapes import (
    PHASE_NODES,
    detuned_rad_s,
    phase_nodes,
    shown,
)
from usmbench.diagnose.known.unmeasured import short_of_ends_deg
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


ALSO_DEG = st.lists(st.floats(-90.0, 90.0), max_size=2)


@given(st.floats(0.0, 1.0), st.floats(1e-12, 1.0), ALSO_DEG)
def test_nodes_are_apart_though_a_curve_does_all_at_one_place(
    at: float, width: float, also_deg: list[float]
) -> None:
    phase_deg = np.linspace(-90.0, 90.0, 2001)
    speed_rad_s = 10.0 * np.tanh((phase_deg - 90.0 * (2.0 * at - 1.0)) / width)
    nodes_deg = np.array(phase_nodes(phase_deg, [speed_rad_s], also_deg=also_deg))
    assert nodes_deg.size == PHASE_NODES
    nearest_deg = [np.min(np.abs(nodes_deg - asked_deg)) for asked_deg in also_deg]
    assert max(nearest_deg, default=0.0) < 0.2
    assert np.all(np.diff(nodes_deg) > 0.0)
    assert (nodes_deg[0], nodes_deg[-1]) == (-90.0, 90.0)


def test_a_node_stands_where_the_drive_stops_short_of_an_end_that_the_warm_up_holds() -> None:
    multisine_deg = 89.0 * np.sin(np.linspace(0.0, 40.0, 2000))
    measured_deg = np.unique(np.r_[multisine_deg, 90.0])
    (short_deg,) = short_of_ends_deg(measured_deg)
    assert short_deg == multisine_deg.max()
    speed_rad_s = np.linspace(-10.0, 10.0, 2001)
    nodes_deg = phase_nodes(
        np.linspace(-89.0, 90.0, 2001), [speed_rad_s], measured_deg, [short_deg]
    )
    assert nodes_deg[-2:] == pytest.approx((short_deg, 90.0))


@given(st.integers(2, 37), st.floats(2.0, 30.0))
def test_nodes_lie_at_measured_phases_where_one_is_near(n: int, corner_deg: float) -> None:
    measured_deg, table_deg = np.linspace(-90.0, 90.0, n), np.linspace(-90.0, 90.0, 2001)
    speed_rad_s = np.copysign(np.maximum(np.abs(table_deg) - corner_deg, 0.0), table_deg)
    nodes_deg = np.array(phase_nodes(table_deg, [speed_rad_s], measured_deg))
    assert np.all(np.diff(nodes_deg) > 0.0)
    away_deg = np.abs(measured_deg[:, None] - nodes_deg).min(axis=1)
    # One that has none of its own would have to share it: nodes are not as dense there.
    assert np.all(away_deg[away_deg > 1e-3] > 0.5)
    off = Gaps.of(measured_deg, table_deg, [speed_rad_s]).at_nodes_rad_s(nodes_deg)
    at_one = np.abs(nodes_deg[:, None] - measured_deg).min(axis=1) < 1e-3
    assert np.all(off[at_one] == 0.0)


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
