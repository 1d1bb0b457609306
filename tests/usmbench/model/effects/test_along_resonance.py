"""Effects that move the motor along its resonance curve, against the model at other frequencies."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.model.effects.amplitude_droop import FORMS as DROOP
from usmbench.model.effects.context import Context
from usmbench.model.effects.crystal_error import FORMS as CRYSTAL
from usmbench.model.effects.generator_imbalance import FORMS as IMBALANCE
from usmbench.model.effects.registry import find_effect
from usmbench.model.effects.thermal_drift import FORMS as WARMING
from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.model.simulate import simulate

Array = NDArray[np.float64]
WINDOW_S = 0.01
FORM = "along the resonance"
ALWAYS_TESTABLE = ("speed", "speed, by turning")
PHASE_DEG = np.repeat(np.linspace(-88.0, 88.0, 41), 5)
# Rising by 1 % in 10 Hz below the resonance, falling above.
SIDES = {40_000.0: 1.0, 41_000.0: -1.0}


def _point(frequency_hz: float, share: float) -> OperatingPoint:
    knots_deg = np.array([-90.0, -45, -8, 8, 45, 90])
    delta = share * np.array([-10.0, -9, 0, 0, 9, 10])
    curve = StaticCurve(knots_deg, delta)
    return OperatingPoint(frequency_hz, 0.0, curve, (-90.0, 90.0), (-8.0, 8.0), 0.01)


@pytest.fixture
def model() -> HammersteinModel:
    points = [
        _point(frequency_hz + step_hz, 1.0 + side * 1e-3 * step_hz)
        for frequency_hz, side in SIDES.items()
        for step_hz in (-50.0, 0.0, 50.0)
    ]
    linear = LinearPart(np.array([-0.05]), np.array([0.6, 0.35]), 0, WINDOW_S)
    return HammersteinModel(linear, tuple(points), "test")


def _speed(
    model: HammersteinModel, frequency_hz: float, name: str = "", form: str = FORM, **values: float
) -> Array:
    effect = {"name": name, "form": form, "parameters": values}
    extended = replace(model, effects=(effect,) if name else ())
    column = np.full(PHASE_DEG.size, frequency_hz)
    return simulate(extended, PHASE_DEG, column, np.zeros(PHASE_DEG.size)).speed_rad_s


@pytest.mark.parametrize("frequency_hz", SIDES)
@pytest.mark.parametrize("ppm", [-400.0, 250.0])
def test_a_crystal_that_is_off_is_the_model_at_the_frequency_that_is_there(
    model: HammersteinModel, frequency_hz: float, ppm: float
) -> None:
    off = _speed(model, frequency_hz, "crystal_error", frequency_error_ppm=ppm)
    there = _speed(model, frequency_hz * (1.0 + 1e-6 * ppm))
    assert np.allclose(off, there, atol=1e-9)
    faster = np.abs(off).max() > np.abs(_speed(model, frequency_hz)).max()
    assert faster == (ppm * SIDES[frequency_hz] > 0.0)


@pytest.mark.parametrize("frequency_hz", SIDES)
def test_a_weak_generator_takes_the_same_share_at_every_frequency(
    model: HammersteinModel, frequency_hz: float
) -> None:
    healthy = _speed(model, frequency_hz)
    weak = _speed(model, frequency_hz, "generator_imbalance", speed_lost=0.03)
    assert np.allclose(weak, 0.97 * healthy, atol=1e-9)


@pytest.mark.parametrize("frequency_hz", SIDES)
def test_a_supply_that_gives_way_does_so_at_speed_at_every_frequency(
    model: HammersteinModel, frequency_hz: float
) -> None:
    healthy = _speed(model, frequency_hz)
    load = (healthy / np.max(np.abs(healthy))) ** 2
    soft = _speed(model, frequency_hz, "amplitude_droop", "at once, " + FORM, droop_at_top=0.03)
    assert np.allclose(soft, (1.0 - 0.03 * load) * healthy, atol=1e-3)


def test_a_supply_with_a_store_gives_way_after_a_while(model: HammersteinModel) -> None:
    values = {"droop_at_top": 0.03, "store_s": 0.02}
    soft = _speed(model, 41_000.0, "amplitude_droop", "after a while, " + FORM, **values)
    share = 1.0 - soft[-5:] / _speed(model, 41_000.0)[-5:]
    assert np.all(np.diff(share) > 0.0)
    assert share[0] > 0.0
    assert share[-1] < 0.03


def test_a_weak_generator_only_weakens() -> None:
    assert all(p.low == p.null == 0.0 for effect in IMBALANCE for p in effect.parameters)


def test_a_resonance_that_moves_up_is_a_frequency_that_comes_down(model: HammersteinModel) -> None:
    late = {"final_shift_ppm": 300.0, "warm_up_s": 3000.0}
    t_s = 1e9 + WINDOW_S * np.arange(1.0, PHASE_DEG.size + 1.0)
    effect = {"name": "thermal_drift", "form": FORM, "parameters": late}
    column = np.full(PHASE_DEG.size, 41_000.0)
    warm = simulate(replace(model, effects=(effect,)), PHASE_DEG, column, 0.0 * column, t_s=t_s)
    off = _speed(model, 41_000.0, "crystal_error", frequency_error_ppm=-300.0)
    assert np.allclose(warm.speed_rad_s, off, atol=1e-9)


def _context(detuning: Array | None) -> Context:
    linear = LinearPart(np.zeros(0), np.ones(1), 0, WINDOW_S)
    t_s = WINDOW_S * np.arange(1.0, 4.0)
    slope = None if detuning is None else lambda phase_deg: detuning * np.sign(phase_deg)
    return Context(
        t_s, WINDOW_S, np.array([-3.0, 2.0, 90.0]), lambda p: 0.1 * p, linear, detuning_rad_s=slope
    )


def test_friction_holds_a_rotor_that_would_start_the_other_way() -> None:
    context = _context(np.array([400.0, 400.0, 400.0]))
    effect = find_effect("crystal_error", FORM)
    at_rest = np.array([0.0, 0.0, 9.0])
    slower = effect.apply(at_rest, context, {"frequency_error_ppm": -1000.0})
    assert np.allclose(slower, [0.0, 0.0, 8.6])
    faster = effect.apply(at_rest, context, {"frequency_error_ppm": 1000.0})
    assert np.allclose(faster, [-0.4, 0.4, 9.4])


@pytest.mark.parametrize(
    ("detuning", "known"),
    [(None, False), (np.full(3, 400.0), True), (np.full(3, 1.0), False)],
    ids=["one frequency", "two", "on the top of the resonance"],
)
def test_one_form_or_the_other_is_testable(detuning: Array | None, known: bool) -> None:
    contexts = [_context(detuning)]
    for effect in (*CRYSTAL, *IMBALANCE, *WARMING, *DROOP):
        testable = effect.untestable(contexts) is None
        along = FORM in effect.form
        assert testable == (known if along else effect.form in ALWAYS_TESTABLE or not known)


def test_without_a_slope_it_cannot_be_simulated() -> None:
    effect = find_effect("crystal_error", FORM)
    with pytest.raises(InputError, match="one drive frequency only"):
        effect.apply(np.ones(3), _context(None), {"frequency_error_ppm": 10.0})
