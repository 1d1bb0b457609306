"""A motor below and above its resonance, driven by a crystal that is off or a weak generator."""

from functools import cache

import numpy as np

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


def curve_at(frequency_hz: float, amplitude: float = 1.0) -> StaticCurve:
    """Return the curve of a motor that the less it vibrates is slower, and held back more."""
    detuning = 2.0 * QUALITY * (frequency_hz / RESONANCE_HZ - 1.0)
    vibration = amplitude / np.hypot(1.0, detuning)
    edge_deg, held_rad_s = 2.0 * vibration**-2.5, vibration**-2.0
    knots_deg = np.array([-90.0, -60, -35, -edge_deg, edge_deg, 35, 60, 90])
    shares = np.array([-1.0, -0.97, -0.8, 0, 0, 0.8, 0.97, 1.0])
    lost_rad_s = held_rad_s * (1.0 - shares**2) * np.sign(shares)
    return StaticCurve(knots_deg, 18.0 * vibration * shares - lost_rad_s)


def driven_at(
    seed: int, frequencies_hz: tuple[float, ...], ppm: float, weaker: float, windows: int = 1600
) -> Record:
    """Return a run at one frequency after another, of a motor that may be ill."""
    rng = np.random.default_rng(seed)
    n = windows // len(frequencies_hz)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, windows // 5), 5)
    settled = [
        curve_at(f * (1.0 + 1e-6 * ppm), 1.0 - weaker).speed_rad_s(phase_deg[k * n : (k + 1) * n])
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


def names_and_alternatives(found: Diagnosis) -> set[str]:
    return {name for cause in found.causes for name in (cause.name, *cause.alternatives)}


@cache
def known_at_two() -> HammersteinModel:
    """Return the model that four healthy runs at both frequencies give."""
    known_hz = [f + step for f in (BELOW_HZ, ABOVE_HZ) for step in (-BESIDE_HZ, 0.0, BESIDE_HZ)]
    points = [
        OperatingPoint(f, 0.0, curve_at(f), (-90.0, 90.0), (None, None), NOISE_RAD_S)
        for f in known_hz
    ]
    runs = [driven_at(seed, (BELOW_HZ, ABOVE_HZ), 0.0, 0.0, 3000) for seed in (1, 2, 3, 4)]
    return with_knowledge(HammersteinModel(LINEAR, tuple(points), "test"), runs)
