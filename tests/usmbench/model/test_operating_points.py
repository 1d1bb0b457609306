"""What the speed does beside the frequencies that a model knows."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.errors import InputError
from usmbench.model.hammerstein import OperatingPoint, StaticCurve
from usmbench.model.operating_points import places_among, point_weights, slope_table

CURVE = StaticCurve(np.array([-90.0, 90.0]), np.array([-10.0, 10.0]))


def _points(*where: tuple[float | None, float]) -> list[OperatingPoint]:
    return [OperatingPoint(f, t, CURVE, (-90.0, 90.0), (None, None), 0.01) for f, t in where]


@settings(deadline=None, max_examples=30)
@given(
    slope=st.floats(-1.0, 1.0),
    steps_hz=st.lists(st.floats(1.0, 500.0), min_size=1, max_size=4),
)
def test_a_straight_resonance_curve_has_its_slope_everywhere(
    slope: float, steps_hz: list[float]
) -> None:
    frequencies_hz = 40_000.0 + np.cumsum([0.0, *steps_hz])
    points = _points(*((float(f), 0.1) for f in frequencies_hz))
    asked_hz = np.array([*frequencies_hz, 0.5 * (frequencies_hz[0] + frequencies_hz[1])])
    weights, _ = point_weights(points, asked_hz.size, asked_hz, np.full(asked_hz.size, 0.1))
    table = slope_table(points)
    assert table is not None
    found = np.array(weights).T @ table @ (slope * frequencies_hz)
    assert np.allclose(found, slope * asked_hz, rtol=1e-6, atol=1e-6)


def test_a_parabola_has_its_slope_at_the_end_and_in_the_middle() -> None:
    frequencies_hz = np.array([40_000.0, 40_025.0, 40_060.0, 41_000.0])
    points = _points(*((float(f), 0.0) for f in frequencies_hz))
    table = slope_table(points)
    assert table is not None
    bent = 3.0 + 0.01 * (frequencies_hz - 40_010.0) ** 2
    assert np.allclose(table @ bent, frequencies_hz * 0.02 * (frequencies_hz - 40_010.0))


def test_the_nearer_neighbour_says_more() -> None:
    points = _points((40_000.0, 0.0), (40_010.0, 0.0), (41_000.0, 0.0))
    table = slope_table(points)
    assert table is not None
    left, _, right = table[1]
    assert abs(left) > 1e3 * abs(right)


@pytest.mark.parametrize(
    "where",
    [
        [(40_000.0, 0.0)],
        [(40_000.0, 0.0), (40_000.0, 0.1)],
        [(40_000.0, 0.0), (40_100.0, 0.0), (40_000.0, 0.1)],
        [(None, 0.0), (None, 0.1)],
    ],
)
def test_one_frequency_has_no_slope(where: list[tuple[float | None, float]]) -> None:
    points = _points(*where)
    assert slope_table(points) is None


def test_places_run_from_the_lowest_to_the_highest() -> None:
    points = _points((40_000.0, 0.1), (41_000.0, 0.1), (40_250.0, 0.1))
    (place,) = places_among(points, list(np.eye(3)))
    assert place == pytest.approx([-1.0, 1.0, -0.5])


def test_places_tell_torque_from_frequency() -> None:
    points = _points((40_000.0, 0.0), (41_000.0, 0.0), (40_000.0, 0.2))
    in_frequency, in_torque = places_among(points, list(np.eye(3)))
    assert in_frequency == pytest.approx([-1.0, 1.0, -1.0])
    assert in_torque == pytest.approx([-1.0, -1.0, 1.0])


def test_points_that_differ_in_nothing_have_no_place() -> None:
    assert places_among(_points((None, 0.0)), [np.ones(3)]) == ()


@pytest.mark.parametrize(
    ("where", "given", "missing"),
    [
        ([(41_000.0, 0.0), (41_500.0, 0.0)], {"torque_nm": np.zeros(3)}, "frequency_hz"),
        ([(41_000.0, 0.0), (41_000.0, 0.2)], {"frequency_hz": np.full(3, 41e3)}, "torque_nm"),
        ([(41_000.0, 0.0), (41_500.0, 0.2)], {}, "frequency_hz"),
    ],
)
def test_a_run_that_does_not_say_where_it_was_is_refused(
    where: list[tuple[float, float]], given: dict[str, np.ndarray], missing: str
) -> None:
    asked = {"frequency_hz": None, "torque_nm": None, **given}
    with pytest.raises(InputError, match=f"the run has no {missing}"):
        point_weights(_points(*where), 3, **asked)


def test_what_all_points_share_need_not_be_said() -> None:
    points = _points((41_000.0, 0.1), (41_500.0, 0.1))
    weights, outside = point_weights(points, 1, np.array([41_250.0]), None)
    assert np.allclose(weights, 0.5)
    assert not outside.any()
