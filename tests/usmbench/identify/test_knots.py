"""Where a curve bends."""

import numpy as np
import pytest

from usmbench.identify.knots import dead_zone_deg, knees_deg, place_knots
from usmbench.identify.prior_rows import prior_rows
from usmbench.model.bernstein import bernstein_basis
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.inverse_map import bezier_abscissa

GRID_DEG = np.linspace(-90.0, 90.0, 2001)


def _fitted(speed_rad_s: np.ndarray, phase_deg: np.ndarray) -> StaticCurve:
    knots_deg = np.linspace(phase_deg[0], phase_deg[-1], 25)
    basis = bernstein_basis(bezier_abscissa(phase_deg, knots_deg), 24)
    pull = prior_rows(knots_deg, 1e-3, None, phase_deg.size)
    rows, wanted = np.vstack([basis, pull]), np.r_[speed_rad_s, np.zeros(len(pull))]
    delta = np.linalg.lstsq(rows, wanted, rcond=None)[0]
    return StaticCurve(knots_deg, np.asarray(delta, dtype=np.float64))


@pytest.mark.parametrize("top_deg", [50.0, 65.0])
def test_a_speed_that_stops_rising_has_a_knee_there(top_deg: float) -> None:
    phase_deg = np.linspace(-90.0, 90.0, 400)
    speed = np.sign(phase_deg) * np.clip((np.abs(phase_deg) - 15.0) / (top_deg - 15.0), 0.0, 1.0)
    curve = _fitted(10.0 * speed, phase_deg)
    edges_deg = tuple(e for e in dead_zone_deg(curve) if e is not None)
    assert sorted(knees_deg(GRID_DEG, curve.speed_rad_s(GRID_DEG), edges_deg)) == pytest.approx(
        [-top_deg, top_deg], abs=4.0
    )


def test_a_speed_that_rises_to_the_end_has_none() -> None:
    phase_deg = np.linspace(-90.0, 90.0, 400)
    curve = _fitted(0.1 * phase_deg, phase_deg)
    assert knees_deg(GRID_DEG, curve.speed_rad_s(GRID_DEG), (-5.0, 5.0)) == ()


def test_a_motor_that_never_turns_has_none() -> None:
    assert knees_deg(GRID_DEG, np.zeros(GRID_DEG.size), (0.0,)) == ()


def test_an_edge_far_outside_gathers_knots_at_the_end() -> None:
    knots_deg = place_knots(0.0, 90.0, 8, (-19.0,), 0.9, 0.45)
    assert np.all(np.diff(knots_deg) > 0.0)
    assert np.allclose(knots_deg, place_knots(0.0, 90.0, 8, (0.0,), 0.9, 0.45))
