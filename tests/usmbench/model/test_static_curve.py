"""A static curve goes on beyond its ends as it ends."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.model.bernstein import bernstein_basis
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.inverse_map import bezier_abscissa

END_DEG = 60.0
KNOTS_DEG = np.linspace(-END_DEG, END_DEG, 25)


def saturating(phase_deg: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(9.0 * np.tanh(phase_deg / 40.0))


def fitted() -> StaticCurve:
    phase_deg = np.linspace(-END_DEG, END_DEG, 200)
    basis = bernstein_basis(bezier_abscissa(phase_deg, KNOTS_DEG), KNOTS_DEG.size - 1)
    return StaticCurve(KNOTS_DEG, np.array(np.linalg.lstsq(basis, saturating(phase_deg))[0], float))


@pytest.mark.parametrize("beyond_deg", [0.5, 3.0, 8.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_saturating_curve_is_met_better_than_by_its_end(beyond_deg: float, side: float) -> None:
    phase_deg = side * np.array([END_DEG, END_DEG + beyond_deg])
    gained = np.diff(fitted().speed_rad_s(phase_deg))
    assert gained == pytest.approx(np.diff(saturating(phase_deg)), rel=0.2)


@given(st.lists(st.floats(-20.0, 20.0), min_size=2, max_size=9), st.floats(0.0, 300.0))
def test_a_curve_is_continuous_and_levels_off(delta: list[float], beyond_deg: float) -> None:
    curve = StaticCurve(np.linspace(-30.0, 50.0, len(delta)), np.array(delta))
    for end_deg, way in ((-30.0, -1.0), (50.0, 1.0)):
        inside, end, beyond, near = curve.speed_rad_s(
            end_deg + way * np.array([-4.0, 0.0, beyond_deg, 1e-9])
        )
        assert near == pytest.approx(end, abs=1e-7)
        assert abs(beyond - end) <= 4.0 * abs(end - inside) + 1e-9
