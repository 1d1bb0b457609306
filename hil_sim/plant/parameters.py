"""Parameters of the simulated USR60, machine by machine, and which figure each was set by.

The published figures are those of Mojallali and Ahmadi, "Hammerstein Based Modeling of Traveling
Wave Ultrasonic Motors" (2011), for the Shinsei USR60: full speed 10.25 rad/s and lag 3.5 ms
(under equation 4), the dead zones at 41, 41.5 and 42 kHz with 0, 0.1 and 0.2 N·m (Section V; the
knots 60, 65, 68, 70 and 75 degrees stand where the edges lie). ``benchmarks/
motor_characteristics.py`` prints what these parameters give beside them.
"""

from dataclasses import dataclass, field, fields, replace
from typing import TypeVar

import numpy as np


@dataclass(frozen=True, slots=True)
class StatorParameters:
    """The two orthogonal standing-wave modes of the stator ring.

    Parameters
    ----------
    resonance_hz
        Resonance of mode A at ambient temperature. Below the three drive frequencies by enough
        that the amplitudes at 41, 41.5 and 42 kHz fall as the published dead zones grow.
    quality_factor
        Quality factor of both modes under preload; sets the same ratios.
    resonance_mismatch_hz
        Resonance of mode B above that of mode A. Gives a natural asymmetry of about 1 %.
    gain_mismatch
        Relative excess of mode B's response over mode A's.
    resonance_drift_hz_per_k
        Change of both resonances with the stator's temperature. Set by the warm-up: speed at
        41 kHz changes by one to two per cent over some minutes.
    """

    resonance_hz: float = 40_500.0
    quality_factor: float = 60.0
    resonance_mismatch_hz: float = 8.0
    gain_mismatch: float = -0.01
    resonance_drift_hz_per_k: float = -0.6


@dataclass(frozen=True, slots=True)
class ContactParameters:
    """Friction between stator and rotor.

    Parameters
    ----------
    speed_per_amplitude_rad_s
        Surface speed of a pure travelling wave as large as the one at resonance. Set by the full
        speed at 41 kHz.
    traction_limit_nm
        Torque at which the driving contact slips fully. Set by the growth of the dead zone with
        load at 41 kHz.
    traction_slip_rad_s
        Slip that uses up most of the traction (its tanh has argument 1). Sets how traction, and
        with it the load's effect, falls from 41 to 42 kHz.
    clamp_limit_nm
        Friction torque where nothing vibrates, which also holds the unpowered rotor. Set by the
        dead zones at 41.5 and 42 kHz.
    release_amplitude
        Vibration amplitude, relative to resonance, that frees the contact (to 1/e). Set by the
        dead zone at 41 kHz without load.
    release_exponent
        Steepness of the release; set by the difference of the dead zones at 41 and 41.5 kHz.
    lift_amplitude
        Amplitude below which the crests do not clear the friction layer, so that a travelling
        wave clamps like a standing one. Sets how fast the rotor stops after the drive.
    backward_ratio
        Surface speed of a backward wave relative to a forward one: not 1 where the teeth lean or
        the friction layer has bedded in one way.
    """

    speed_per_amplitude_rad_s: float = 18.5
    traction_limit_nm: float = 0.85
    traction_slip_rad_s: float = 8.6
    clamp_limit_nm: float = 1.25
    release_amplitude: float = 0.466
    release_exponent: float = 5.75
    lift_amplitude: float = 0.05
    backward_ratio: float = 1.0


@dataclass(frozen=True, slots=True)
class RotorParameters:
    """Rotor, shaft and what turns with them.

    Parameters
    ----------
    inertia_kg_m2
        Moment of inertia of rotor, shaft, coupling, disc and brake. Set by the lag of 3.5 ms.
    bearing_friction_nm
        Friction torque of the bearings.
    breakaway_ratio
        Friction at rest relative to friction in motion, at least 1.
    weight_nm
        Constant torque, positive in the positive direction (a weight on a pulley).
    noise_nm
        Standard deviation of the torque noise.
    noise_correlation_s
        Correlation time of the torque noise.
    """

    inertia_kg_m2: float = 2.65e-4
    bearing_friction_nm: float = 0.005
    breakaway_ratio: float = 1.0
    weight_nm: float = 0.0
    noise_nm: float = 0.001
    noise_correlation_s: float = 0.01


@dataclass(frozen=True, slots=True)
class ThermalParameters:
    """Heating of the stator: two heat capacities in a row, then the surroundings.

    Parameters
    ----------
    ambient_c
        Temperature of the surroundings.
    dielectric_loss_w
        Loss in the ceramic at nominal drive voltage of both phases.
    vibration_loss_w
        Loss in ring and friction layer at the amplitude of resonance.
    stator_capacity_j_per_k, housing_capacity_j_per_k
        Heat capacities.
    stator_resistance_k_per_w
        Thermal resistance from the stator to the housing.
    housing_resistance_k_per_w
        Thermal resistance from the housing to the surroundings.
    """

    ambient_c: float = 23.0
    dielectric_loss_w: float = 1.5
    vibration_loss_w: float = 11.0
    stator_capacity_j_per_k: float = 25.0
    housing_capacity_j_per_k: float = 110.0
    stator_resistance_k_per_w: float = 2.0
    housing_resistance_k_per_w: float = 2.5


@dataclass(frozen=True, slots=True)
class DiscParameters:
    """The code wheel HEDS-5140 A11 behind an HEDS-9040.

    Parameters
    ----------
    lines
        Lines of the wheel.
    start_offset_counts
        Where the wheel stands inside a count at the start, 0…1.
    index_count
        Count, from the start position, at which the index pulse lies.
    """

    lines: int = 500
    start_offset_counts: float = 0.5
    index_count: int = 137


_Part = TypeVar("_Part", StatorParameters, ContactParameters, RotorParameters, ThermalParameters)

# Spread of each drawn parameter relative to the overall spread; what is not named stays.
_RELATIVE_SPREAD = {
    "resonance_hz": 0.01,
    "quality_factor": 0.5,
    "speed_per_amplitude_rad_s": 1.0,
    "traction_limit_nm": 1.0,
    "traction_slip_rad_s": 1.0,
    "clamp_limit_nm": 1.0,
    "release_amplitude": 0.3,
    "inertia_kg_m2": 1.0,
    "bearing_friction_nm": 3.0,
    "resonance_drift_hz_per_k": 3.0,
    "dielectric_loss_w": 3.0,
    "vibration_loss_w": 3.0,
    "stator_capacity_j_per_k": 1.0,
    "stator_resistance_k_per_w": 3.0,
    "housing_resistance_k_per_w": 3.0,
}


def _vary(part: _Part, rng: np.random.Generator, spread: float) -> _Part:
    """Draw every parameter of one machine that varies between motors, log-normally."""
    drawn = {
        f.name: getattr(part, f.name)
        * float(np.exp(spread * _RELATIVE_SPREAD[f.name] * rng.standard_normal()))
        for f in fields(part)
        if f.name in _RELATIVE_SPREAD
    }
    return replace(part, **drawn)


@dataclass(frozen=True, slots=True)
class PlantParameters:
    """Everything that makes one motor on its testbed.

    Parameters
    ----------
    stator, contact, rotor, thermal, disc
        The machines.
    """

    stator: StatorParameters = field(default_factory=StatorParameters)
    contact: ContactParameters = field(default_factory=ContactParameters)
    rotor: RotorParameters = field(default_factory=RotorParameters)
    thermal: ThermalParameters = field(default_factory=ThermalParameters)
    disc: DiscParameters = field(default_factory=DiscParameters)

    @classmethod
    def draw(cls, rng: np.random.Generator, *, spread: float = 0.02) -> "PlantParameters":
        """Draw another motor of the same type.

        Parameters
        ----------
        rng
            Where the draw comes from.
        spread
            Relative standard deviation of speed constant, friction and inertia; half of it for the
            quality factor, a hundredth for the resonance, three times for what heat and bearings
            do. 0 gives the default motor but for the mismatch of the modes and the position of
            the disc, which are drawn in any case.

        Returns
        -------
        PlantParameters
            The motor drawn.
        """
        base = cls()
        stator = replace(
            _vary(base.stator, rng, spread),
            resonance_mismatch_hz=float(rng.normal(0.0, 4.0)),
            gain_mismatch=float(rng.normal(0.0, 0.01)),
        )
        disc = replace(
            base.disc,
            start_offset_counts=float(rng.uniform()),
            index_count=int(rng.integers(4 * base.disc.lines)),
        )
        return cls(
            stator=stator,
            contact=_vary(base.contact, rng, spread),
            rotor=_vary(base.rotor, rng, spread),
            thermal=_vary(base.thermal, rng, spread),
            disc=disc,
        )
