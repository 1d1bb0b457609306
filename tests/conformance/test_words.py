"""The words each request sends to the chips, and what they make of the drive."""

from typing import TYPE_CHECKING

import pytest

from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import RequestType, ResetCause

if TYPE_CHECKING:
    from tests.conformance.conftest import BenchHost

CONTROL, RESET, PSELECT, FSELECT = 0x2028, 0x0100, 0x0400, 0x0800
HZ_PER_WORD = wire.DDS_CLOCK_HZ / 2**wire.DDS_FREQUENCY_BITS
DEG_PER_WORD = 360.0 / 2**wire.DDS_PHASE_BITS


def test_set_drive_loads_the_idle_registers_and_flips(bench_host: "BenchHost") -> None:
    bench_host.ask(RequestType.IDENTIFY)
    bench_host.new_words()
    bench_host.ask(RequestType.SET_DRIVE, 441_857, -3)
    low, high = 441_857 & 0x3FFF, 441_857 >> 14
    control = CONTROL | RESET | FSELECT | PSELECT
    assert bench_host.new_words() == [
        ("ab", 0x8000 | low),
        ("ab", 0x8000 | high),
        ("b", 0xE000 | 0xFFD),
        ("ab", control),
    ]
    bench_host.ask(RequestType.SET_DRIVE, 441_857, 2048)
    assert bench_host.new_words() == [
        ("ab", 0x4000 | low),
        ("ab", 0x4000 | high),
        ("b", 0xC000 | 0x800),
        ("ab", CONTROL | RESET),
    ]


def test_set_phase_loads_the_idle_phase_and_flips_it_alone(bench_host: "BenchHost") -> None:
    bench_host.start()
    bench_host.new_words()
    bench_host.ask(RequestType.SET_PHASE, -1)
    assert bench_host.new_words() == [("b", 0xCFFF), ("ab", CONTROL | FSELECT)]
    bench_host.ask(RequestType.SET_PHASE, 1)
    assert bench_host.new_words() == [("b", 0xE001), ("ab", CONTROL | FSELECT | PSELECT)]


def test_outputs_writes_the_control_word_each_time(bench_host: "BenchHost") -> None:
    bench_host.start()
    bench_host.new_words()
    on = CONTROL | FSELECT | PSELECT
    for value, word in ((1, on), (0, on | RESET), (0, on | RESET), (1, on)):
        bench_host.ask(RequestType.OUTPUTS, value)
        assert bench_host.new_words() == [("ab", word)]


def test_a_stop_for_silence_writes_the_control_word(bench_host: "BenchHost") -> None:
    bench_host.start()
    bench_host.new_words()
    bench_host.line.wait(1.1)
    assert bench_host.new_words() == [("ab", CONTROL | FSELECT | PSELECT | RESET)]


def test_what_has_no_effect_writes_nothing(bench_host: "BenchHost") -> None:
    bench_host.start()
    bench_host.new_words()
    bench_host.ask(RequestType.HEARTBEAT)
    bench_host.status()
    bench_host.ask(RequestType.IDENTIFY)
    bench_host.ask(RequestType.SET_DRIVE, 0, 0)
    bench_host.ask(RequestType.SET_PHASE, 3000)
    bench_host.ask(RequestType.OUTPUTS, 7)
    assert bench_host.new_words() == []


def test_each_setting_changes_the_drive_once(bench_host: "BenchHost") -> None:
    bench_host.start(440_000, 0)
    bench_host.line.board.drive_changes.clear()
    for frequency_word, phase_word in ((441_000, 1000), (441_000, -1000), (430_000, -1000)):
        bench_host.ask(RequestType.SET_DRIVE, frequency_word, phase_word)
        ((_, drive),) = bench_host.line.board.drive_changes
        bench_host.line.board.drive_changes.clear()
        assert drive.frequency_hz == pytest.approx(frequency_word * HZ_PER_WORD, rel=1e-12)
        assert drive.phase_deg == pytest.approx(phase_word * DEG_PER_WORD, abs=1e-12)
        assert (drive.amplitude_a, drive.amplitude_b) == (1.0, 1.0)


def test_settings_made_while_off_wait_for_the_outputs(bench_host: "BenchHost") -> None:
    bench_host.start(440_000, 0)
    bench_host.ask(RequestType.OUTPUTS, 0)
    bench_host.ask(RequestType.SET_DRIVE, 441_000, 500)
    assert not bench_host.line.drives()
    bench_host.ask(RequestType.OUTPUTS, 1)
    drive = bench_host.line.board.drive_changes[-1][1]
    assert drive.frequency_hz == pytest.approx(441_000 * HZ_PER_WORD, rel=1e-12)
    assert drive.phase_deg == pytest.approx(500 * DEG_PER_WORD, abs=1e-12)
    bench_host.line.reset(ResetCause.EXTERNAL)
    assert not bench_host.line.drives()
