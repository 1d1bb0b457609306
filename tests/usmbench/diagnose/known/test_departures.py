"""How a run's speed departs with what wanders."""

from dataclasses import replace

import numpy as np
import pytest

from tests.usmbench.diagnose.known.wandering_motor import driven, slipping_motor
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.dead_zone import edge_of_standstill_deg
from usmbench.diagnose.known.departures import departures
from usmbench.model.applied import Applied
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record


@pytest.fixture(scope="module")
def plain() -> HammersteinModel:
    return slipping_motor()


def test_a_habit_that_is_half_again_as_strong_is_half_of_its_departure(
    plain: HammersteinModel,
) -> None:
    (stretch,), _ = cut_runs([driven(1, 1.0, 1.0)], plain, ())
    grid = Applied(find_effect("phase_quantisation", "rounded"), {"step_deg": 0.1})
    sticking = Applied(find_effect("stick_slip", ""), {"lost_rad_s": 0.2, "fades_rad_s": 2.0})
    more = replace(sticking, values={**sticking.values, "lost_rad_s": 0.3})
    usual, stronger = (
        extended_run([grid, each], stretch.context).speed_rad_s for each in (sticking, more)
    )
    habit = departures(stretch, [grid, sticking], 2)[:, -1]
    runs_on = np.abs(stretch.settled_rad_s) > 0.5
    np.testing.assert_allclose(0.5 * habit[runs_on], (stronger - usual)[runs_on], atol=0.05)
    assert np.max(np.abs(habit[runs_on])) > 0.1
    assert not np.any(departures(stretch, [grid], 2)[:, -1])
    assert not np.any(departures(stretch, [], 2)[:, -1])


def test_friction_takes_most_near_standstill_and_nothing_at_the_top(
    plain: HammersteinModel,
) -> None:
    (stretch,), _ = cut_runs([driven(3, 1.0, 1.0)], plain, ())
    gain, _, tilted, _, _, _, _, _, _, *held_back = departures(stretch, (), 2).T[:11]
    np.testing.assert_array_equal(gain, stretch.simulated_rad_s)
    calm, settled = stretch.lag > 8, stretch.settled_rad_s
    np.testing.assert_allclose(tilted[calm], (gain * stretch.places[0])[calm], atol=0.03)
    for held, weight in zip(held_back, stretch.points, strict=True):
        slowed = -held * np.sign(settled)
        there = calm & (weight == 1.0)
        assert np.max(np.abs(held[calm & (weight == 0.0)])) < 0.01
        assert np.min(slowed[there & (np.abs(settled) > 0.5) & (np.abs(settled) < 2.0)]) > 0.9
        assert np.max(np.abs(held[there & (np.abs(settled) < 1e-3)]), initial=0.0) < 0.02
        assert np.max(slowed[there & (np.abs(settled) > 0.999 * np.max(np.abs(settled)))]) < 0.1


def test_what_wanders_passes_through_the_lag_as_the_speed_does() -> None:
    """Also where a jump leads to another side, at rest, or to another speed."""
    nodes_deg, n = np.linspace(-90.0, 90.0, 19), 900
    away_deg = np.maximum(np.abs(nodes_deg) - np.where(nodes_deg < 0.0, 9.0, 13.0), 0.0)
    curve = StaticCurve(nodes_deg, 0.1 * np.sign(nodes_deg) * away_deg)
    point = OperatingPoint(None, None, curve, (-90.0, 90.0), (None, None), 0.01)
    linear = first_order(0.004, 0.0, 0.01)
    stays_deg = np.random.default_rng(8).choice(np.linspace(-88.0, 88.0, 9), n // 3)
    phase_deg, t_s = np.repeat(stays_deg, 3), 0.01 * np.arange(1.0, n + 1.0)
    record = Record("run", t_s, phase_deg, np.zeros(n), np.full(n, 0.01))
    (stretch,), _ = cut_runs([record], HammersteinModel(linear, (point,), "test"), ())
    _, tilted, *_, wider, one_sided, at_ends = departures(stretch, (), 1).T[:8]
    settled, way = stretch.settled_rad_s, np.sign(phase_deg)
    edge_deg = edge_of_standstill_deg(stretch)
    fast = 2.0 * np.abs(settled) / np.max(np.abs(settled)) - 1.0
    inside_deg = 1e-3 * edge_deg
    toward_end = np.clip((np.abs(phase_deg) - edge_deg) / (90.0 - edge_deg), 0.0, 1.0)
    for found, changed_rad_s in (
        (tilted, settled * (1.0 + 1e-3 * fast)),
        (wider, curve.speed_rad_s(phase_deg - inside_deg * way)),
        (one_sided, curve.speed_rad_s(phase_deg - inside_deg)),
        (at_ends, curve.speed_rad_s(phase_deg - inside_deg * toward_end)),
    ):
        change = (free_run(linear, changed_rad_s) - free_run(linear, settled)) / 1e-3
        let_go = stretch.use & (stretch.lag == 0) & (phase_deg == 0.0)
        np.testing.assert_allclose(found[stretch.use], change[stretch.use], atol=0.02)
        assert np.max(np.abs(change[let_go])) > 0.08
