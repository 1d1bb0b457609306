"""Print what each part of the board adds to the phase between its two outputs.

``python firmware/phase_budget.py``. Errors are of phase B against phase A, in degrees at 41 kHz;
what both channels share cancels. BOARD.md explains the rows, schematic.yaml has the parts.
"""

import cmath
import math

FREQUENCY_HZ = 41_000.0
DDS_CLOCK_HZ = 25e6
PHASE_BITS = 12
SUPPLY_V = 5.0
# Of each Sallen-Key section: both resistors, the capacitor to its output, the one to ground.
SECTIONS = ((2080.0, 2080.0, 1.2e-9, 1.0e-9), (876.0, 876.0, 6.8e-9, 1.0e-9))
PART_TOLERANCES = (0.001, 0.001, 0.01, 0.01)
OP_AMP_BANDWIDTH_HZ = 8e6
AMPLIFIER_BANDWIDTH_HZ = 5e6
BANDWIDTH_TOLERANCE = 0.2
AMPLIFIER_GAIN = 1.0 + 1000.0 / 453.0
TRANSFORMER_RATIO = 18.0
SKEW_S = 1e-9
MOTOR_CYCLES = 300  # over which the stator's resonance averages, about its quality factor
HARMONIC = 3

Section = tuple[float, float, float, float]


def degrees(delay_s: float) -> float:
    """Return the phase that a delay makes of the drive.

    Parameters
    ----------
    delay_s
        The delay.
    """
    return 360.0 * FREQUENCY_HZ * delay_s


def low_pass(frequency_hz: float, section: Section) -> complex:
    """Return the response of a Sallen-Key section with a gain of 1.

    Parameters
    ----------
    frequency_hz
        Where.
    section
        Both resistances in ohms, the capacitances to the output and to ground in farads.
    """
    first_ohm, second_ohm, output_f, ground_f = section
    s = 2j * math.pi * frequency_hz
    damping = ground_f * (first_ohm + second_ohm)
    return 1.0 / (1.0 + s * damping + s * s * first_ohm * second_ohm * output_f * ground_f)


def filter_response(frequency_hz: float) -> complex:
    """Return the response of both sections.

    Parameters
    ----------
    frequency_hz
        Where.
    """
    return low_pass(frequency_hz, SECTIONS[0]) * low_pass(frequency_hz, SECTIONS[1])


def filter_mismatch() -> float:
    """Return the phase between two filters whose parts are each off by their tolerance."""
    shifts = []
    for section in SECTIONS:
        nominal = low_pass(FREQUENCY_HZ, section)
        for part, tolerance in enumerate(PART_TOLERANCES):
            parts = list(section)
            # Both channels vary: their difference is the square root of two wider.
            parts[part] *= 1.0 + tolerance * math.sqrt(2.0)
            off = low_pass(FREQUENCY_HZ, (parts[0], parts[1], parts[2], parts[3]))
            shifts.append(math.degrees(cmath.phase(off / nominal)))
    return math.hypot(*shifts)


def amplifier_mismatch(bandwidth_hz: float, stages: int) -> float:
    """Return the phase between two chains of amplifiers with one pole, each at its tolerance.

    Parameters
    ----------
    bandwidth_hz
        Of each amplifier.
    stages
        How many follow each other in a channel.
    """
    lag_deg = math.degrees(math.atan(FREQUENCY_HZ / bandwidth_hz))
    return lag_deg * BANDWIDTH_TOLERANCE * math.sqrt(2.0 * stages)


def rows() -> list[tuple[str, float]]:
    """Return each part's name and its error in degrees."""
    clock_deg = degrees(1.0 / DDS_CLOCK_HZ)
    edge_rms = clock_deg * math.sqrt(2.0 / 12.0)
    return [
        ("phase word, half a step", 180.0 / 2**PHASE_BITS),
        ("edges fall on the 25 MHz clock, as the motor averages them (rms)",
         edge_rms / math.sqrt(MOTOR_CYCLES)),
        ("clock, SCLK and output wiring, 1 ns", degrees(SKEW_S)),
        ("filters, 0.1 % resistors and 1 % capacitors (rms)", filter_mismatch()),
        ("filters' op-amps, 8 MHz ± 20 % (rms)", amplifier_mismatch(OP_AMP_BANDWIDTH_HZ, 2)),
        ("power amplifiers, 5 MHz ± 20 % (rms)", amplifier_mismatch(AMPLIFIER_BANDWIDTH_HZ, 1)),
        ("avoided by U5: one chip a clock later than the other", clock_deg),
    ]  # fmt: skip


def main() -> None:
    """Print the budget as a table, and the levels along the output stage."""
    print("| part | phase error |\n|---|---|")
    for name, error_deg in rows():
        print(f"| {name} | {error_deg:.3f}° |")
    through = filter_response(FREQUENCY_HZ)
    harmonic = abs(filter_response(HARMONIC * FREQUENCY_HZ) / through) / HARMONIC
    square_v = 2.0 / math.pi * SUPPLY_V  # fundamental of a square wave, peak
    power_v = square_v * abs(through) * AMPLIFIER_GAIN
    motor_v = power_v * TRANSFORMER_RATIO / math.sqrt(2.0)
    print(
        f"\nfilter: {abs(math.degrees(cmath.phase(through))):.0f}° behind in both channels; ",
        end="",
    )
    print(f"third harmonic {100.0 * harmonic:.1f} % of the fundamental")
    print(f"levels: {square_v:.2f} V peak, {power_v:.1f} V peak, {motor_v:.0f} V rms")


if __name__ == "__main__":
    main()
