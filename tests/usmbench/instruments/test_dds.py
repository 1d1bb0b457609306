"""DDS words: the nearest one, over the whole range, against exact fractions."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.instruments import dds

FREQUENCY_STEP_HZ = Fraction(25_000_000, 2**28)
PHASE_STEP_DEG = Fraction(360, 2**12)
# Doubles carry a word of 28 bits with 2**-24 of a step to spare.
HALF_A_STEP = Fraction(1, 2) + Fraction(1, 2**22)


@given(st.floats(0.0, 12_500_000.0))
def test_frequency_is_off_by_half_a_step_at_most(frequency_hz: float) -> None:
    word = dds.frequency_to_word(frequency_hz)
    assert abs(word * FREQUENCY_STEP_HZ - Fraction(frequency_hz)) <= HALF_A_STEP * FREQUENCY_STEP_HZ


@given(st.floats(-180.0, 180.0))
def test_phase_is_off_by_half_a_step_at_most(phase_deg: float) -> None:
    word = dds.phase_to_word(phase_deg)
    assert -2048 <= word <= 2048
    assert abs(word * PHASE_STEP_DEG - Fraction(phase_deg)) <= HALF_A_STEP * PHASE_STEP_DEG


@given(st.integers(0, 2**28 - 1))
def test_every_frequency_word_comes_back(word: int) -> None:
    assert dds.frequency_to_word(dds.word_to_frequency_hz(word)) == word


@given(st.integers(-2048, 2048))
def test_every_phase_word_comes_back(word: int) -> None:
    assert dds.phase_to_word(dds.word_to_phase_deg(word)) == word
    assert (dds.signed_phase_word(word & 0xFFF) - word) % 4096 == 0


@pytest.mark.parametrize(
    ("register", "word"), [(0, 0), (1, 1), (2047, 2047), (2048, 2048), (2049, -2047), (4095, -1)]
)
def test_signed_phase_word(register: int, word: int) -> None:
    assert dds.signed_phase_word(register) == word
    assert dds.signed_phase_word(register - 4096) == word


def test_steps_are_those_of_the_data_sheet() -> None:
    assert pytest.approx(0.0931, abs=1e-4) == dds.FREQUENCY_STEP_HZ
    assert pytest.approx(0.0879, abs=1e-4) == dds.PHASE_STEP_DEG
