"""The chip, held against its data sheet."""

import pytest

from hil_sim import ad9833
from hil_sim.ad9833 import Ad9833

CLOCK_HZ = 25e6


def written(*words: int) -> Ad9833:
    chip = Ad9833()
    for word in words:
        chip.write_word(word)
    return chip


def test_the_data_sheets_example_of_400_hz() -> None:
    # Application note AN-1070 programs 400 Hz at 25 MHz with these words.
    chip = written(0x2100, 0x50C7, 0x4000, 0xC000, 0x2000)
    assert chip.frequency_word == 0x10C7
    assert chip.output_hz(CLOCK_HZ) == pytest.approx(400.0, abs=0.05)
    assert chip.running


def test_a_pair_of_writes_reaches_the_register_only_when_whole() -> None:
    chip = written(ad9833.B28, 0x4001, 0x4002)
    chip.write_word(0x4003)
    assert chip.frequency_word == 2 << 14 | 1
    chip.write_word(0x4004)
    assert chip.frequency_word == 4 << 14 | 3


def test_halves_of_different_registers_do_not_make_a_pair() -> None:
    chip = written(ad9833.B28, 0x4001, 0x8002, 0x8003)
    assert chip.frequency_registers == [0, 3 << 14 | 2]


@pytest.mark.parametrize(("hlb", "expected"), [(0, 5 << 14 | 9), (ad9833.HLB, 9 << 14 | 7)])
def test_single_writes_change_one_half(hlb: int, expected: int) -> None:
    chip = written(ad9833.B28, 0x4007, 0x4005, hlb, 0x4009)
    assert chip.frequency_word == expected


def test_select_bits_choose_the_registers_in_force() -> None:
    chip = written(ad9833.B28, 0x4001, 0x4000, 0x8002, 0x8000, 0xC123, 0xF456)
    assert (chip.frequency_word, chip.phase_word) == (1, 0x123)
    chip.write_word(ad9833.B28 | ad9833.FSELECT)
    assert (chip.frequency_word, chip.phase_word) == (2, 0x123)
    chip.write_word(ad9833.B28 | ad9833.PSELECT)
    assert (chip.frequency_word, chip.phase_word) == (1, 0x456)


@pytest.mark.parametrize(
    ("control", "running"),
    [
        (0, True),
        (ad9833.RESET, False),
        (ad9833.SLEEP1, False),
        (ad9833.SLEEP12, False),
        (ad9833.SLEEP12 | ad9833.OPBITEN, True),
        (ad9833.SLEEP1 | ad9833.OPBITEN, False),
    ],
)
def test_what_stops_the_output(control: int, running: bool) -> None:
    assert written(control).running is running


@pytest.mark.parametrize(
    ("control", "share"), [(ad9833.OPBITEN | ad9833.DIV2, 1.0), (ad9833.OPBITEN, 0.5), (0, 1.0)]
)
def test_the_square_wave_is_halved_without_div2(control: int, share: float) -> None:
    chip = written(ad9833.B28, 0x4000, 0x4001, control)
    assert chip.output_hz(2.0**28) == share * (1 << 14)
