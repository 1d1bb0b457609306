"""The simulation between and beyond the points it was identified at."""

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.model.hammerstein import (
    HammersteinModel,
    LinearPart,
    OperatingPoint,
    StaticCurve,
)
from usmbench.model.simulate import simulate


def point(frequency_hz: float | None, torque_nm: float | None, top: float) -> OperatingPoint:
    curve = StaticCurve(np.array([-90.0, 0.0, 90.0]), np.array([-top, 0.0, top]))
    return OperatingPoint(frequency_hz, torque_nm, curve, (-90.0, 90.0), (None, None), 0.0)


def model(*points: OperatingPoint) -> HammersteinModel:
    return HammersteinModel(LinearPart(np.array([-0.1]), np.array([0.9]), 0, 0.01), points, "fast")


GRID = model(
    *(point(f, t, f / 1e3 - 10 * t) for f in (41_000.0, 42_000.0) for t in (0.0, 0.1, 0.2))
)


def test_linear_surfaces_are_interpolated_exactly() -> None:
    rng = np.random.default_rng(0)
    frequency_hz, torque_nm = rng.uniform(41e3, 42e3, 40), rng.uniform(0.0, 0.2, 40)
    simulation = simulate(GRID, np.full(40, 90.0), frequency_hz, torque_nm)
    assert np.allclose(simulation.settled_rad_s, frequency_hz / 1e3 - 10 * torque_nm, rtol=1e-9)
    assert np.all(simulation.inside)


def test_points_on_a_line_are_interpolated_along_it() -> None:
    line = model(point(41e3, 0.1, 10.0), point(42e3, 0.1, 8.0))
    simulation = simulate(line, np.full(3, 90.0), np.array([41e3, 41.5e3, 42e3]), np.full(3, 0.1))
    assert simulation.settled_rad_s.tolist() == pytest.approx([10.0, 9.0, 8.0])
    assert np.all(simulation.inside)


@pytest.mark.parametrize(("frequency_hz", "torque_nm"), [(43e3, 0.1), (41.5e3, 0.3), (40e3, 0.0)])
def test_beyond_the_points_it_says_so(frequency_hz: float, torque_nm: float) -> None:
    simulation = simulate(GRID, np.zeros(2), np.full(2, frequency_hz), np.full(2, torque_nm))
    assert np.all(simulation.outside_point)
    assert not np.any(simulation.inside)


def test_beyond_the_phases_the_curve_turns_back_and_says_so() -> None:
    there, back = (
        simulate(model(point(None, None, 10.0)), np.array(phases_deg))
        for phases_deg in ([80.0, 95.0, -120.0], [80.0, 85.0, -60.0])
    )
    assert there.outside_phase.tolist() == [False, True, True]
    assert there.settled_rad_s == pytest.approx(back.settled_rad_s)


def test_one_point_serves_a_run_that_does_not_say_where_it_was() -> None:
    assert np.all(simulate(model(point(41e3, 0.0, 10.0)), np.zeros(3)).inside)


def test_several_points_need_to_be_told_which() -> None:
    with pytest.raises(InputError, match="the run has no frequency_hz"):
        simulate(GRID, np.zeros(3))


@pytest.mark.parametrize(
    ("phase_deg", "words"),
    [(np.empty(0), "no row"), (np.array([0.0, np.nan]), "phase_deg of row 1 is no number")],
)
def test_nothing_to_simulate_is_refused(phase_deg: np.ndarray, words: str) -> None:
    with pytest.raises(InputError, match=words):
        simulate(GRID, phase_deg)


def test_the_dynamics_follow_the_curve() -> None:
    phase_deg = np.r_[np.zeros(3), np.full(20, 90.0)]
    simulation = simulate(model(point(None, None, 10.0)), phase_deg)
    assert simulation.speed_rad_s[:3].tolist() == [0.0, 0.0, 0.0]
    assert simulation.speed_rad_s[3] == pytest.approx(9.0)
    assert simulation.speed_rad_s[-1] == pytest.approx(10.0)
