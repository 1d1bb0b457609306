"""The stator: two orthogonal standing waves, followed as slowly varying complex amplitudes.

In the frame that turns with the drive at angular frequency Ω, mode k obeys

    dz_k/dt = (−σ_k + i(Ω_k − Ω)) z_k + σ_k g_k u_k,   σ_k = Ω_k / (2 Q),

with u_A = amplitude A and u_B = amplitude B · exp(iφ), so that |z| = 1 at resonance and nominal
voltage. The drive is constant between two commands, so each step is exact. The waves that run
either way round the ring have the amplitudes |z_A ∓ i z_B| / 2 (for the modes see
Hagood and McFarland, "Modeling of a piezoelectric rotary ultrasonic motor", IEEE Trans. Ultrason.,
Ferroelect., Freq. Control 42, 1995, pp. 210-224).
"""

import cmath
import math
from typing import NamedTuple

from hil_sim.plant.parameters import StatorParameters
from hil_sim.signals import Drive

# A relative residue of the transient this small moves the rotor by less than its noise does.
_SETTLED = 1e-5


class Vibration(NamedTuple):
    """The ring's vibration, as the contact feels it.

    Parameters
    ----------
    amplitude
        Root mean square of both modes' amplitudes; 1 at resonance and nominal voltage.
    travelling_share
        Energy of the forward minus that of the backward wave over their sum, −1…1: the sine of
        the phase between two equal modes. 0 is a standing wave.
    """

    amplitude: float
    travelling_share: float


class Stator:
    """Envelopes of both modes under a drive that is constant between commands.

    Parameters
    ----------
    parameters
        The modes.
    """

    def __init__(self, parameters: StatorParameters):
        self._parameters = parameters
        self._drive = Drive()
        self._warming_k = 0.0
        self._z_a = 0j
        self._z_b = 0j
        self.residue = 0.0
        self._set_targets()

    def set_drive(self, drive: Drive) -> None:
        """Put another drive in force; the frequency changes with continuous phase.

        Parameters
        ----------
        drive
            The voltages.
        """
        self._drive = drive
        self._set_targets()

    def set_warming(self, warming_k: float) -> None:
        """Move the resonances with the temperature.

        Parameters
        ----------
        warming_k
            Temperature of the ring above the surroundings.
        """
        if warming_k != self._warming_k:
            self._warming_k = warming_k
            self._set_targets()

    @property
    def settled(self) -> bool:
        """Whether the transient since the last command is over."""
        return self.residue <= _SETTLED

    @property
    def vibration(self) -> Vibration:
        """The vibration now."""
        return _vibration(self._z_a, self._z_b)

    @property
    def envelopes(self) -> tuple[complex, complex]:
        """Complex amplitudes of both modes in the frame of the drive."""
        return self._z_a, self._z_b

    @envelopes.setter
    def envelopes(self, envelopes: tuple[complex, complex]) -> None:
        self._z_a, self._z_b = envelopes
        self._settle()

    def advance(self, duration_s: float) -> Vibration:
        """Move on and return the vibration in the middle of the step.

        Parameters
        ----------
        duration_s
            Length of the step.

        Returns
        -------
        Vibration
            At half the step, which makes the rotor's step second order in the vibration.
        """
        half_a = cmath.exp(self._rate_a * (0.5 * duration_s))
        half_b = cmath.exp(self._rate_b * (0.5 * duration_s))
        off_a = (self._z_a - self._target_a) * half_a
        off_b = (self._z_b - self._target_b) * half_b
        middle = _vibration(self._target_a + off_a, self._target_b + off_b)
        self._z_a = self._target_a + off_a * half_a
        self._z_b = self._target_b + off_b * half_b
        self._settle()
        return middle

    def _settle(self) -> None:
        """Take the targets where the transient is over."""
        self.residue = abs(self._z_a - self._target_a) + abs(self._z_b - self._target_b)
        if self.settled:
            self._z_a, self._z_b = self._target_a, self._target_b

    def _set_targets(self) -> None:
        """Steady envelopes and complex rates of both modes for the drive in force."""
        p, drive = self._parameters, self._drive
        resonance_hz = p.resonance_hz + p.resonance_drift_hz_per_k * self._warming_k
        u_b = cmath.rect(drive.amplitude_b, math.radians(drive.phase_deg))
        self._rate_a, self._target_a = self._mode(resonance_hz, complex(drive.amplitude_a))
        self._rate_b, self._target_b = self._mode(
            resonance_hz + p.resonance_mismatch_hz, (1.0 + p.gain_mismatch) * u_b
        )
        self._settle()

    def _mode(self, resonance_hz: float, force: complex) -> tuple[complex, complex]:
        """Rate and steady envelope of one mode under a force."""
        damping = math.pi * resonance_hz / self._parameters.quality_factor
        rate = complex(-damping, 2.0 * math.pi * (resonance_hz - self._drive.frequency_hz))
        return rate, -damping * force / rate


def _vibration(z_a: complex, z_b: complex) -> Vibration:
    """Amplitude and travelling share of two envelopes."""
    energy = 0.5 * (z_a.real**2 + z_a.imag**2 + z_b.real**2 + z_b.imag**2)
    if energy == 0.0:
        return Vibration(0.0, 0.0)
    return Vibration(math.sqrt(energy), (z_a.real * z_b.imag - z_a.imag * z_b.real) / energy)
