"""Words of the AD9833 direct digital synthesiser, and the quantities they stand for.

The chip adds its frequency word to a 28-bit phase accumulator at every clock, and its 12-bit phase
word to the accumulator's top bits: f = word · f_clock / 2²⁸, φ = word · 360° / 2¹² (AD9833 data
sheet, "Numerically Controlled Oscillator Plus Phase Modulator").
"""

from typing import Final

from usmbench.instruments.protocol._generated import (
    DDS_CLOCK_HZ,
    DDS_FREQUENCY_BITS,
    DDS_PHASE_BITS,
)

FREQUENCY_STEP_HZ: Final = DDS_CLOCK_HZ / (1 << DDS_FREQUENCY_BITS)
PHASE_STEP_DEG: Final = 360.0 / (1 << DDS_PHASE_BITS)

_PHASE_TURN: Final = 1 << DDS_PHASE_BITS


def frequency_to_word(frequency_hz: float) -> int:
    """Return the frequency word nearest to a frequency; off by half a step at most.

    Parameters
    ----------
    frequency_hz
        Finite frequency.
    """
    return round(frequency_hz / FREQUENCY_STEP_HZ)


def word_to_frequency_hz(word: int) -> float:
    """Return the frequency that a word produces.

    Parameters
    ----------
    word
        Frequency word.
    """
    return word * FREQUENCY_STEP_HZ


def phase_to_word(phase_deg: float) -> int:
    """Return the signed phase word nearest to a phase shift; off by half a step at most.

    Parameters
    ----------
    phase_deg
        Finite phase shift; −180° and 180° become −2048 and 2048, which sound alike.
    """
    return round(phase_deg / PHASE_STEP_DEG)


def word_to_phase_deg(word: int) -> float:
    """Return the phase shift that a signed word produces.

    Parameters
    ----------
    word
        Signed phase word.
    """
    return word * PHASE_STEP_DEG


def signed_phase_word(register: int) -> int:
    """Return the signed word of a chip's 12-bit phase register, in −2047…2048.

    Parameters
    ----------
    register
        Register value, or the difference of two, modulo 4096.
    """
    return (register - _PHASE_TURN // 2 - 1) % _PHASE_TURN - _PHASE_TURN // 2 + 1
