"""The slope along the resonance, from curves that are off where few phases were measured."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.model.hammerstein import OperatingPoint, StaticCurve
from usmbench.model.resonance_slope import mixed_slope, point_slopes

Array = NDArray[np.float64]
STEPS_HZ = (-25.0, 0.0, 25.0)
FREQUENCY_HZ = 40_000.0
KNOTS_DEG = np.linspace(-90.0, 90.0, 61)
PHASE_DEG = np.linspace(-88.0, 88.0, 89)


def settled_rad_s(phase_deg: Array, vibration: float, friction: float = 1.0) -> Array:
    """Return the speed of crests that a friction holds back, less as the wave travels."""
    crests = 10.0 * vibration * np.sin(np.radians(phase_deg))
    held = friction / vibration**4 * np.cos(np.radians(phase_deg)) ** 2
    return np.asarray(np.sign(crests) * np.maximum(np.abs(crests) - held, 0.0))


def points_off_by(off: Array) -> list[OperatingPoint]:
    """Return three points near each other, the curve of each off by so much at its knots."""
    return [
        OperatingPoint(
            FREQUENCY_HZ + step_hz,
            0.0,
            StaticCurve(KNOTS_DEG, settled_rad_s(KNOTS_DEG, 1.0 + 1e-3 * step_hz) + error),
            (-89.0, 89.0),
            (None, None),
            0.01,
        )
        for step_hz, error in zip(STEPS_HZ, off, strict=True)
    ]


def exact_rad_s(phase_deg: Array) -> Array:
    """Return f ∂v/∂f of curves that are off by nothing."""
    slopes = point_slopes(points_off_by(np.zeros((3, KNOTS_DEG.size))))
    assert slopes is not None
    return slopes[1].difference_rad_s(phase_deg)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10_000))
def test_errors_of_curves_at_their_ends_hardly_show(seed: int) -> None:
    rng = np.random.default_rng(seed)
    few = np.abs(KNOTS_DEG) > 84.0
    points = points_off_by(np.where(few, rng.normal(0.0, 0.05, (3, KNOTS_DEG.size)), 0.0))
    slopes = point_slopes(points)
    assert slopes is not None
    runs, exact = np.abs(settled_rad_s(PHASE_DEG, 1.0)) > 1.0, exact_rad_s(PHASE_DEG)
    found, plain = (of(PHASE_DEG) - exact for of in (slopes[1].rad_s, slopes[1].difference_rad_s))
    top = np.max(np.abs(exact))
    assert np.max(np.abs(found[runs])) < max(0.1 * top, 0.5 * np.max(np.abs(plain[runs])))


def test_curves_that_are_right_keep_their_slope_at_each_point() -> None:
    slopes = point_slopes(points_off_by(np.zeros((3, KNOTS_DEG.size))))
    assert slopes is not None
    rows = np.arange(PHASE_DEG.size)
    weights = tuple((rows % 3 == k).astype(float) for k in range(3))
    everywhere = mixed_slope(slopes, weights)
    assert everywhere is not None
    mixed = everywhere(PHASE_DEG)
    for k, slope in enumerate(slopes):
        own = slope.rad_s(PHASE_DEG)
        assert np.array_equal(mixed[rows % 3 == k], own[rows % 3 == k])
    runs = (rows % 3 == 1) & (np.abs(settled_rad_s(PHASE_DEG, 1.0)) > 2.0)
    assert np.allclose(mixed[runs], exact_rad_s(PHASE_DEG)[runs], rtol=0.06)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10_000))
def test_the_ends_of_a_near_three_are_no_worse_than_its_middle(seed: int) -> None:
    """A parabola from one side would make four times as much of the curves' errors."""
    rng = np.random.default_rng(seed)
    points = points_off_by(rng.normal(0.0, 0.03, (3, 1)) * np.ones(KNOTS_DEG.size))
    slopes = point_slopes(points)
    assert slopes is not None
    for end in (slopes[0], slopes[2]):
        np.testing.assert_allclose(end.difference_rad_s(PHASE_DEG), _middle(points, PHASE_DEG))


def test_where_the_speed_changes_much_from_one_to_the_next_an_end_keeps_its_parabola() -> None:
    speeds = [settled_rad_s(KNOTS_DEG, vibration) for vibration in (0.7, 1.0, 0.9)]
    points = [
        OperatingPoint(f, 0.0, StaticCurve(KNOTS_DEG, speed), (-89.0, 89.0), (None, None), 0.01)
        for f, speed in zip((40_000.0, 40_500.0, 41_000.0), speeds, strict=True)
    ]
    slopes = point_slopes(points)
    assert slopes is not None
    low, high = (float(s.difference_rad_s(np.array([60.0]))[0]) for s in (slopes[0], slopes[2]))
    assert low > 0.0 > high


def _middle(points: list[OperatingPoint], phase_deg: Array) -> Array:
    low, high = (points[k].curve.speed_rad_s(phase_deg) for k in (0, 2))
    return np.asarray(FREQUENCY_HZ * (high - low) / (STEPS_HZ[2] - STEPS_HZ[0]))


def test_at_rest_and_where_too_few_phases_tell_it_is_the_plain_difference() -> None:
    points = points_off_by(np.zeros((3, KNOTS_DEG.size)))
    slopes = point_slopes(points)
    assert slopes is not None
    rest = np.array([-1e-3, 0.0, 1e-3])
    assert np.array_equal(slopes[1].rad_s(rest), slopes[1].difference_rad_s(rest))
    narrow = point_slopes([_within(p, (-89.0, 10.0)) for p in points])
    assert narrow is not None
    phase_deg = np.array([7.0, 9.0])
    assert np.array_equal(narrow[1].rad_s(phase_deg), narrow[1].difference_rad_s(phase_deg))


def _within(point: OperatingPoint, range_deg: tuple[float, float]) -> OperatingPoint:
    return OperatingPoint(
        point.frequency_hz, 0.0, point.curve, range_deg, (None, None), point.noise_rad_s
    )


def test_one_frequency_has_none() -> None:
    slopes = point_slopes(points_off_by(np.zeros((3, KNOTS_DEG.size)))[:1])
    assert slopes is None
    assert mixed_slope(slopes, [np.ones(5)]) is None


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_motor_that_is_wired_the_other_way_is_the_same(sign: float) -> None:
    points = points_off_by(np.zeros((3, KNOTS_DEG.size)))
    turned = [
        OperatingPoint(
            p.frequency_hz, 0.0, StaticCurve(KNOTS_DEG, sign * p.curve.delta), p.phase_range_deg,
            (None, None), 0.01,
        )
        for p in points
    ]  # fmt: skip
    plain, other = point_slopes(points), point_slopes(turned)
    assert plain is not None
    assert other is not None
    assert np.allclose(other[1].rad_s(PHASE_DEG), sign * plain[1].rad_s(PHASE_DEG))
