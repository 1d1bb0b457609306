"""Two causes that are one at one drive frequency, on a motor with a resonance, and told at two."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.experiment.next_experiment import propose
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.diagnose.result import Diagnosis
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

WINDOW_S, NOISE_RAD_S = 0.01, 0.01
RESONANCE_HZ, QUALITY = 40_500.0, 60.0
BELOW_HZ, ABOVE_HZ, BESIDE_HZ = 40_050.0, 41_000.0, 25.0
LINEAR = first_order(0.0035, 0.0015, WINDOW_S)


def _curve(frequency_hz: float, amplitude: float = 1.0) -> StaticCurve:
    """Return the curve of a motor that the less it vibrates is slower, and held back more."""
    detuning = 2.0 * QUALITY * (frequency_hz / RESONANCE_HZ - 1.0)
    vibration = amplitude / np.hypot(1.0, detuning)
    edge_deg, held_rad_s = 2.0 * vibration**-2.5, vibration**-2.0
    knots_deg = np.array([-90.0, -60, -35, -edge_deg, edge_deg, 35, 60, 90])
    shares = np.array([-1.0, -0.97, -0.8, 0, 0, 0.8, 0.97, 1.0])
    lost_rad_s = held_rad_s * (1.0 - shares**2) * np.sign(shares)
    return StaticCurve(knots_deg, 18.0 * vibration * shares - lost_rad_s)


def _driven(
    seed: int, frequencies_hz: tuple[float, ...], ppm: float, weaker: float, windows: int = 1600
) -> Record:
    """Return a run at one frequency after another, of a motor that may be ill."""
    rng = np.random.default_rng(seed)
    n = windows // len(frequencies_hz)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, windows // 5), 5)
    settled = [
        _curve(f * (1.0 + 1e-6 * ppm), 1.0 - weaker).speed_rad_s(phase_deg[k * n : (k + 1) * n])
        for k, f in enumerate(frequencies_hz)
    ]
    speed = free_run(LINEAR, np.concatenate(settled))
    noisy = speed + NOISE_RAD_S * rng.standard_normal(speed.size)
    t_s = WINDOW_S * np.arange(1.0, speed.size + 1.0)
    return Record(
        f"run {seed}",
        t_s,
        phase_deg,
        noisy,
        np.full(speed.size, WINDOW_S),
        frequency_hz=np.repeat(np.array(frequencies_hz), n),
        torque_nm=np.zeros(speed.size),
    )


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    known_hz = [f + step for f in (BELOW_HZ, ABOVE_HZ) for step in (-BESIDE_HZ, 0.0, BESIDE_HZ)]
    points = [
        OperatingPoint(f, 0.0, _curve(f), (-90.0, 90.0), (None, None), NOISE_RAD_S)
        for f in known_hz
    ]
    runs = [_driven(seed, (BELOW_HZ, ABOVE_HZ), 0.0, 0.0, 3000) for seed in (1, 2, 3, 4)]
    return with_knowledge(HammersteinModel(LINEAR, tuple(points), "test"), runs)


@pytest.fixture(scope="module")
def at_one_frequency(model: HammersteinModel) -> HammersteinModel:
    points = tuple(p for p in model.points if p.frequency_hz == ABOVE_HZ)
    runs = [_driven(seed, (ABOVE_HZ,), 0.0, 0.0) for seed in (1, 2, 3, 4)]
    return with_knowledge(replace(model, points=points, residual={}), runs)


@pytest.fixture(scope="module")
def slower(model: HammersteinModel) -> tuple[Record, Diagnosis]:
    """Return a run at one frequency whose crystal is off, and what is said of it."""
    record = _driven(7, (ABOVE_HZ,), 150.0, 0.0)
    return record, diagnose([record], model)


def _set(found: Diagnosis) -> set[str]:
    return {name for cause in found.causes for name in (cause.name, *cause.alternatives)}


@pytest.mark.parametrize(
    ("ppm", "weaker", "name", "other"),
    [
        (40.0, 0.0, "crystal_error", "generator_imbalance"),
        (-40.0, 0.0, "crystal_error", "generator_imbalance"),
        (0.0, 0.005, "generator_imbalance", "crystal_error"),
    ],
)
def test_two_drive_frequencies_tell_a_crystal_from_a_generator(
    model: HammersteinModel, ppm: float, weaker: float, name: str, other: str
) -> None:
    found = diagnose([_driven(7, (BELOW_HZ, ABOVE_HZ), ppm, weaker)], model)
    assert [cause.name for cause in found.causes] == [name]
    assert other not in _set(found)
    (size,) = found.causes[0].parameters
    truth = ppm if name == "crystal_error" else weaker
    assert size.value == pytest.approx(truth, rel=0.15)


def test_with_nothing_hidden_two_frequencies_show_nothing(model: HammersteinModel) -> None:
    found = diagnose([_driven(11, (BELOW_HZ, ABOVE_HZ), 0.0, 0.0)], model)
    assert found.verdict == "no_discrepancy"


def test_one_drive_frequency_leaves_both_and_the_more_probable_first(
    model: HammersteinModel, slower: tuple[Record, Diagnosis]
) -> None:
    for found in (slower[1], diagnose([_driven(7, (ABOVE_HZ,), 0.0, 0.02)], model)):
        assert _set(found) >= {"crystal_error", "generator_imbalance"}
        # A generator can only be weaker, and so explains a loss the more readily.
        assert found.causes[0].name == "generator_imbalance"


def test_a_plan_at_another_frequency_is_proposed_to_decide(
    model: HammersteinModel, slower: tuple[Record, Diagnosis]
) -> None:
    record, found = slower
    proposal = propose(found, [record], model)
    assert proposal is not None
    assert proposal["odds_after"] > 0.9
    assert proposal["plan"]["frequency_hz"] == [ABOVE_HZ, BELOW_HZ]


def test_a_speed_that_rose_is_no_weak_generator(model: HammersteinModel) -> None:
    found = diagnose([_driven(7, (ABOVE_HZ,), -150.0, 0.0)], model)
    assert found.causes[0].name == "crystal_error"
    assert "generator_imbalance" not in _set(found)


def test_a_model_of_one_frequency_leaves_both(at_one_frequency: HammersteinModel) -> None:
    found = diagnose([_driven(7, (ABOVE_HZ,), 60.0, 0.0)], at_one_frequency)
    assert _set(found) >= {"crystal_error", "generator_imbalance"}
    assert {c.form for c in found.candidates if c.name == "crystal_error"} == {""}
