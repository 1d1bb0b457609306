"""What differs from run to run: what moves with it, how far, and that it is no news."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.wander import Wander, departures, wander_from_mapping
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import Applied, extended_run
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

WINDOW_S, NOISE_RAD_S = 0.01, 0.008
SLIP_RAD_S = {40_050.0: 0.1, 41_000.0: 1.0}  # that friction takes near standstill
LINEAR = first_order(0.0035, 0.0015, WINDOW_S)


def _curve(frequency_hz: float, gain: float = 1.0, friction: float = 1.0) -> StaticCurve:
    """Return the curve of a rotor that follows the crests but for a slip."""
    phase_deg = np.linspace(-90.0, 90.0, 181)
    shares = np.sin(np.radians(phase_deg))
    slip_rad_s = friction * SLIP_RAD_S[frequency_hz] * (1.0 - shares**2)
    speed_rad_s = np.maximum(11.0 * gain * np.abs(shares) - slip_rad_s, 0.0) * np.sign(shares)
    return StaticCurve(phase_deg, speed_rad_s)


def _driven(
    seed: int,
    gain: float,
    friction: float,
    *,
    late_s: float = 0.0,
    tilt: float = 0.0,
    warms: float = 0.0,
) -> Record:
    """Return a run on a day of its own, half of it at each frequency, in an order that turns."""
    n = 2000
    rng = np.random.default_rng(seed)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, n // 10), 10)
    frequency_hz = np.repeat(sorted(SLIP_RAD_S, reverse=bool(seed % 2)), n // 2)
    settled = np.zeros(n)
    for f, side in zip(SLIP_RAD_S, (-1.0, 1.0), strict=True):
        at = frequency_hz == f
        settled[at] = _curve(f, gain + side * tilt, friction).speed_rad_s(phase_deg[at])
    settled *= 1.0 + warms * np.expm1(-np.arange(n) * WINDOW_S / 10.0)
    linear = first_order(0.0035, 0.0015 + late_s, WINDOW_S)
    speed = free_run(linear, settled) + NOISE_RAD_S * rng.standard_normal(n)
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    window_s, torque_nm = np.full(n, WINDOW_S), np.zeros(n)
    return Record(
        f"run {seed}",
        t_s,
        phase_deg,
        speed,
        window_s,
        frequency_hz=frequency_hz,
        torque_nm=torque_nm,
    )


@pytest.fixture(scope="module")
def plain() -> HammersteinModel:
    points = [
        OperatingPoint(f, 0.0, _curve(f), (-90.0, 90.0), (None, None), NOISE_RAD_S)
        for f in SLIP_RAD_S
    ]
    return HammersteinModel(LINEAR, tuple(points), "test")


def test_a_gain_that_wanders_but_for_the_slip_is_no_news(plain: HammersteinModel) -> None:
    off = 0.015 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    model = with_knowledge(plain, [_driven(k, 1.0 + g, 1.0) for k, g in enumerate(off, start=10)])
    for seed, gain in ((1, 1.014), (2, 0.987), (3, 1.006)):
        assert diagnose([_driven(seed, gain, 1.0)], model).verdict == "no_discrepancy"


def test_friction_wanders_at_each_operating_point_by_its_own_amount(
    plain: HammersteinModel,
) -> None:
    off = 0.03 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    model = with_knowledge(plain, [_driven(k, 1.0, 1.0 + c) for k, c in enumerate(off, start=10)])
    wander = wander_from_mapping(model.residual["diagnosis"])
    low_rad_s, high_rad_s = wander.held_back_rad_s
    assert low_rad_s < 0.3 * high_rad_s
    assert 0.5 < high_rad_s / np.std(off, ddof=1) < 2.0
    assert wander.gain < 1e-3


def test_a_gain_that_wanders_more_at_one_frequency_is_no_drift(plain: HammersteinModel) -> None:
    """Half of a run at each frequency: what differs between them looks like time passing."""
    off = 0.01 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    days = [_driven(k, 1.0 + g, 1.0, tilt=0.2 * g) for k, g in enumerate(off, start=10)]
    model = with_knowledge(plain, days)
    wander = wander_from_mapping(model.residual["diagnosis"])
    assert wander.gain_tilt[1] == pytest.approx(0.2 * np.std(off, ddof=1), rel=0.5)
    for seed, gain in ((1, 0.012), (2, -0.01)):
        record = _driven(seed, 1.0 + gain, 1.0, tilt=0.2 * gain)
        assert diagnose([record], model).verdict == "no_discrepancy"


def test_commands_that_meet_the_windows_sooner_or_later_are_no_news(
    plain: HammersteinModel,
) -> None:
    late_s = 1e-4 * np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    model = with_knowledge(
        plain, [_driven(k, 1.0, 1.0, late_s=t) for k, t in enumerate(late_s, start=10)]
    )
    wander = wander_from_mapping(model.residual["diagnosis"])
    assert 0.7 < wander.late_s / np.std(late_s, ddof=1) < 2.0
    assert wander.gain < 1e-3
    for seed, t in ((1, 1.2e-4), (2, -1e-4)):
        assert diagnose([_driven(seed, 1.0, 1.0, late_s=t)], model).verdict == "no_discrepancy"


def test_the_runs_show_how_much_their_warm_up_differs(plain: HammersteinModel) -> None:
    off = np.array([-1.2, 0.4, 1.1, -0.3, 0.9, -0.9])
    shares = []
    for spread in (0.0, 0.3):
        days = enumerate(0.02 * (1.0 + spread * off), start=10)
        model = with_knowledge(plain, [_driven(k, 1.0, 1.0, warms=w) for k, w in days])
        shares.append(wander_from_mapping(model.residual["diagnosis"]).warms_gain)
    alike, otherwise = shares
    assert alike < 5e-4
    # Their time constant is the shortest of those that count.
    assert 0.2 < otherwise / (0.006 * np.std(off, ddof=1)) < 1.0


def test_a_habit_that_is_half_again_as_strong_is_half_of_its_departure(
    plain: HammersteinModel,
) -> None:
    (stretch,), _ = cut_runs([_driven(1, 1.0, 1.0)], plain, ())
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
    (stretch,), _ = cut_runs([_driven(3, 1.0, 1.0)], plain, ())
    gain, _, tilted, _, _, _, *held_back = departures(stretch, (), 2).T[:8]
    np.testing.assert_array_equal(gain, stretch.simulated_rad_s)
    np.testing.assert_array_equal(tilted, gain * stretch.places[0])
    calm, settled = stretch.lag > 8, stretch.settled_rad_s
    for held, weight in zip(held_back, stretch.points, strict=True):
        slowed = -held * np.sign(settled)
        there = calm & (weight == 1.0)
        assert np.max(np.abs(held[calm & (weight == 0.0)])) < 0.01
        assert np.min(slowed[there & (np.abs(settled) > 0.5) & (np.abs(settled) < 2.0)]) > 0.9
        assert np.max(np.abs(held[there & (np.abs(settled) < 1e-3)]), initial=0.0) < 0.02
        assert np.max(slowed[there & (np.abs(settled) > 0.999 * np.max(np.abs(settled)))]) < 0.1


def test_the_wander_comes_back_from_the_model_file() -> None:
    some = Wander(0.01, (1e-3, 2e-3), 1e-4, 0.02, (0.1, 0.2), 1e-3, 0.01, 1e-5, 0.1, 3)
    assert wander_from_mapping(some.to_mapping()) == some
