"""Every request, every refusal, every limit."""

import struct
from typing import TYPE_CHECKING

import pytest

from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import Flags, Refusal, RequestType, ResetCause
from usmbench.instruments.protocol.frames import encode_frame

if TYPE_CHECKING:
    from tests.conformance.conftest import BenchHost, Host

FREQUENCY_WORD = 440_000
LENGTHS = {
    kind: struct.calcsize("<" + "".join(code for _, code in layout))
    for kind, layout in wire.REQUEST_LAYOUTS.items()
}


def test_identify_tells_versions_limits_and_resolution(host: "Host") -> None:
    reply = host.ask(RequestType.IDENTIFY)
    layout = wire.REPLY_LAYOUTS[RequestType.IDENTIFY]
    values = struct.unpack("<" + "".join(code for _, code in layout), reply.payload)
    told = dict(zip([name for name, _ in layout], values, strict=True))
    assert not told.pop("flags") & Flags.NOT_IDENTIFIED
    assert told == {
        "protocol_version": wire.PROTOCOL_VERSION,
        "firmware_major": 1,
        "firmware_minor": 0,
        "clock_hz": wire.DDS_CLOCK_HZ,
        "frequency_word_min": wire.FREQUENCY_WORD_MIN,
        "frequency_word_max": wire.FREQUENCY_WORD_MAX,
        "phase_word_min": wire.PHASE_WORD_MIN,
        "phase_word_max": wire.PHASE_WORD_MAX,
        "frequency_bits": wire.DDS_FREQUENCY_BITS,
        "phase_bits": wire.DDS_PHASE_BITS,
        "host_silence_ms": wire.HOST_SILENCE_MS,
    }


def test_status_after_power_on(bench_host: "BenchHost") -> None:
    assert bench_host.status() == (Flags.NOT_IDENTIFIED, ResetCause.POWER_ON, 0, 0, 0, 0, 0, 0, 0)


def test_flags_follow_the_commands(host: "Host") -> None:
    configured, on = Flags.CONFIGURED, Flags.OUTPUTS_ON
    host.ask(RequestType.IDENTIFY)
    assert host.ask(RequestType.SET_DRIVE, FREQUENCY_WORD, 1).flags == configured
    assert host.ask(RequestType.OUTPUTS, 1).flags == configured | on
    assert host.ask(RequestType.SET_PHASE, 2).flags == configured | on
    assert host.ask(RequestType.HEARTBEAT).flags == configured | on
    assert host.ask(RequestType.OUTPUTS, 0).flags == configured


@pytest.mark.parametrize("phase_word", [0, 1, -1, 2047, -2047, 2048, -2048])
def test_status_gives_the_words_in_force(host: "Host", phase_word: int) -> None:
    host.ask(RequestType.IDENTIFY)
    host.ask(RequestType.SET_DRIVE, FREQUENCY_WORD, phase_word)
    status = host.status()
    assert (status.frequency_word_a, status.frequency_word_b) == (FREQUENCY_WORD, FREQUENCY_WORD)
    assert (status.phase_word_a, status.phase_word_b) == (0, phase_word & 0xFFF)


@pytest.mark.parametrize("word", [wire.FREQUENCY_WORD_MIN, wire.FREQUENCY_WORD_MAX])
def test_frequency_limits_themselves_are_obeyed(host: "Host", word: int) -> None:
    host.ask(RequestType.IDENTIFY)
    assert host.ask(RequestType.SET_DRIVE, word, 0).acknowledged
    assert host.status().frequency_word_b == word


@pytest.mark.parametrize(
    "word",
    [
        wire.FREQUENCY_WORD_MIN - 1,
        wire.FREQUENCY_WORD_MAX + 1,
        0,
        # each byte alone out of range, and the ends of the number's range
        FREQUENCY_WORD + (1 << 24),
        FREQUENCY_WORD ^ (1 << 19),
        0x7FFF_FFFF,
        0x8000_0000 + FREQUENCY_WORD,
        0xFFFF_FFFF,
    ],
)
def test_frequencies_out_of_range_are_refused(host: "Host", word: int) -> None:
    host.ask(RequestType.IDENTIFY)
    host.ask(RequestType.SET_DRIVE, FREQUENCY_WORD, 7)
    reply = host.ask(RequestType.SET_DRIVE, word, 0)
    assert reply.reason == Refusal.FREQUENCY_OUT_OF_RANGE
    assert host.status()[3:7] == (FREQUENCY_WORD, FREQUENCY_WORD, 0, 7)


@pytest.mark.parametrize("word", [-2049, 2049, -32768, 32767, -2048 - 256, 2048 + 256, 4096])
def test_phases_out_of_range_are_refused(host: "Host", word: int) -> None:
    host.ask(RequestType.IDENTIFY)
    host.ask(RequestType.SET_DRIVE, FREQUENCY_WORD, 7)
    drive = host.ask(RequestType.SET_DRIVE, FREQUENCY_WORD + 1, word)
    phase = host.ask(RequestType.SET_PHASE, word)
    assert (drive.reason, phase.reason) == (Refusal.PHASE_OUT_OF_RANGE, Refusal.PHASE_OUT_OF_RANGE)
    assert host.status()[3:7] == (FREQUENCY_WORD, FREQUENCY_WORD, 0, 7)


@pytest.mark.parametrize("value", [2, 3, 128, 255])
def test_outputs_takes_nothing_but_0_and_1(host: "Host", value: int) -> None:
    host.ask(RequestType.IDENTIFY)
    host.ask(RequestType.SET_DRIVE, FREQUENCY_WORD, 0)
    assert host.ask(RequestType.OUTPUTS, value).reason == Refusal.BAD_VALUE
    assert not host.status().flags & Flags.OUTPUTS_ON


def test_types_that_no_request_has_are_refused(host: "Host") -> None:
    host.ask(RequestType.IDENTIFY)
    for kind in (kind for kind in range(0x80) if kind not in list(RequestType)):
        reply = host.ask_raw(encode_frame(9, kind, b"\1\2"))
        assert (reply.sequence, reply.type) == (9, kind | wire.REFUSAL_BITS)
        assert reply.reason == Refusal.UNKNOWN_COMMAND


def test_replies_of_another_board_are_ignored(host: "Host") -> None:
    host.ask(RequestType.IDENTIFY)
    before = host.status().bad_frames
    assert host.exchange(b"".join(encode_frame(9, kind, b"") for kind in range(0x80, 0x100))) == []
    assert host.status().bad_frames == before


@pytest.mark.parametrize("kind", list(RequestType))
def test_wrong_lengths_are_refused(host: "Host", kind: RequestType) -> None:
    host.ask(RequestType.IDENTIFY)
    for length in (n for n in range(wire.MAX_PAYLOAD + 1) if n != LENGTHS[kind]):
        reply = host.ask_raw(encode_frame(length, kind, bytes(length)))
        assert (reply.type, reply.reason) == (kind | wire.REFUSAL_BITS, Refusal.WRONG_LENGTH)


@pytest.mark.parametrize(
    ("kind", "fields"),
    [
        (RequestType.SET_DRIVE, (FREQUENCY_WORD, 0)),
        (RequestType.SET_DRIVE, (0, 9999)),
        (RequestType.SET_PHASE, (0,)),
        (RequestType.SET_PHASE, (9999,)),
        (RequestType.OUTPUTS, (1,)),
        (RequestType.OUTPUTS, (2,)),
        (RequestType.HEARTBEAT, ()),
    ],
)
def test_an_unidentified_board_refuses(
    bench_host: "BenchHost", kind: RequestType, fields: tuple[int, ...]
) -> None:
    reply = bench_host.ask(kind, *fields)
    assert (reply.reason, reply.flags) == (Refusal.NOT_IDENTIFIED, Flags.NOT_IDENTIFIED)


def test_an_unidentified_board_switches_off_and_reports(bench_host: "BenchHost") -> None:
    assert bench_host.ask(RequestType.OUTPUTS, 0).acknowledged
    assert bench_host.status().flags == Flags.NOT_IDENTIFIED


def test_outputs_stay_off_until_configured(bench_host: "BenchHost") -> None:
    bench_host.ask(RequestType.IDENTIFY)
    assert bench_host.ask(RequestType.SET_PHASE, 5).acknowledged
    assert bench_host.ask(RequestType.OUTPUTS, 1).reason == Refusal.NOT_CONFIGURED
    assert bench_host.ask(RequestType.OUTPUTS, 2).reason == Refusal.BAD_VALUE
    bench_host.ask(RequestType.SET_DRIVE, FREQUENCY_WORD, 0)
    assert bench_host.ask(RequestType.OUTPUTS, 1).acknowledged


def test_length_comes_before_everything_else_that_is_wrong(bench_host: "BenchHost") -> None:
    reply = bench_host.ask_raw(encode_frame(1, RequestType.OUTPUTS, b"\2\2"))
    assert reply.reason == Refusal.WRONG_LENGTH


def test_frequency_comes_before_phase(host: "Host") -> None:
    host.ask(RequestType.IDENTIFY)
    reply = host.ask(RequestType.SET_DRIVE, 0, 9999)
    assert reply.reason == Refusal.FREQUENCY_OUT_OF_RANGE


@pytest.mark.parametrize(
    ("kind", "fields"),
    [
        (RequestType.SET_DRIVE, (FREQUENCY_WORD, 0)),
        (RequestType.SET_PHASE, (0,)),
        (RequestType.OUTPUTS, (1,)),
    ],
)
def test_a_board_whose_stack_failed_will_not_drive(
    bench_host: "BenchHost", kind: RequestType, fields: tuple[int, ...]
) -> None:
    bench_host.line.reset(ResetCause.STACK)
    assert bench_host.ask(RequestType.IDENTIFY).flags == Flags.INTERNAL_FAULT
    assert bench_host.ask(kind, *fields).reason == Refusal.INTERNAL_FAULT
    assert bench_host.ask(RequestType.OUTPUTS, 0).acknowledged
    assert bench_host.ask(RequestType.OUTPUTS, 2).reason == Refusal.BAD_VALUE
    assert bench_host.ask(RequestType.HEARTBEAT).acknowledged
    assert bench_host.status().faults == wire.Faults.STACK
