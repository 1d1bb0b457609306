"""The envelopes against closed forms and against the oscillator they stand for."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hil_sim.plant.parameters import StatorParameters
from hil_sim.plant.stator import Stator
from hil_sim.signals import Drive

MATCHED = StatorParameters(resonance_mismatch_hz=0.0, gain_mismatch=0.0)


def settled(parameters: StatorParameters, drive: Drive, warming_k: float = 0.0) -> Stator:
    stator = Stator(parameters)
    stator.set_warming(warming_k)
    stator.set_drive(drive)
    stator.advance(1.0)
    return stator


def test_amplitude_is_one_at_resonance() -> None:
    drive = Drive(MATCHED.resonance_hz, 90.0, 1.0, 1.0)
    assert settled(MATCHED, drive).vibration.amplitude == pytest.approx(1.0, abs=1e-4)


def test_amplitude_falls_to_half_the_energy_at_half_the_bandwidth() -> None:
    half_width_hz = MATCHED.resonance_hz / (2.0 * MATCHED.quality_factor)
    drive = Drive(MATCHED.resonance_hz + half_width_hz, 90.0, 1.0, 1.0)
    assert settled(MATCHED, drive).vibration.amplitude ** 2 == pytest.approx(0.5, rel=1e-6)


@pytest.mark.parametrize("phase_deg", [-180.0, -135.0, -90.0, -20.0, 0.0, 33.0, 90.0, 170.0])
def test_travelling_share_is_the_sine_of_the_phase(phase_deg: float) -> None:
    stator = settled(MATCHED, Drive(41_000.0, phase_deg, 1.0, 1.0))
    expected = math.sin(math.radians(phase_deg))
    assert stator.vibration.travelling_share == pytest.approx(expected, abs=1e-12)


def test_one_phase_alone_makes_a_standing_wave() -> None:
    assert settled(MATCHED, Drive(41_000.0, 90.0, 1.0, 0.0)).vibration.travelling_share == 0.0


def test_steps_compose_exactly() -> None:
    drive = Drive(41_200.0, 60.0, 1.0, 0.8)
    once, often = Stator(StatorParameters()), Stator(StatorParameters())
    once.set_drive(drive)
    often.set_drive(drive)
    once.advance(1.0e-3)
    for _ in range(100):
        often.advance(1.0e-5)
    assert often.envelopes == pytest.approx(once.envelopes, rel=1e-12)


def test_warming_moves_the_resonance() -> None:
    drifting = StatorParameters(resonance_drift_hz_per_k=-2.0)
    shifted = StatorParameters(resonance_hz=drifting.resonance_hz - 20.0)
    drive = Drive(41_000.0, 90.0, 1.0, 1.0)
    assert settled(drifting, drive, 10.0).envelopes == settled(shifted, drive).envelopes


def test_envelope_follows_the_oscillator_it_stands_for() -> None:
    """Mode A of x'' + 2σx' + ω²x = 2σω·cos(Ωt): |z| is the amplitude of the oscillation."""
    omega = 2.0 * math.pi * MATCHED.resonance_hz
    sigma = omega / (2.0 * MATCHED.quality_factor)
    drive = Drive(41_000.0, 0.0, 1.0, 0.0)
    big_omega = 2.0 * math.pi * drive.frequency_hz

    def oscillator(t: float, x: np.ndarray) -> list[float]:
        force = 2.0 * sigma * omega * math.cos(big_omega * t)
        return [x[1], force - 2.0 * sigma * x[1] - omega**2 * x[0]]

    end_s = 1.2e-3
    times_s = np.linspace(end_s - 1.0 / drive.frequency_hz, end_s, 200)
    solution = solve_ivp(oscillator, (0, end_s), [0, 0], t_eval=times_s, rtol=1e-8, atol=1e-10)
    stator = Stator(MATCHED)
    stator.set_drive(drive)
    stator.advance(end_s - 0.5 / drive.frequency_hz)
    amplitude = float(np.ptp(solution.y[0])) / 2.0
    # The slowly-varying-amplitude approximation is good to the order of 1/Q.
    assert abs(stator.envelopes[0]) == pytest.approx(amplitude, rel=1.0 / MATCHED.quality_factor)
