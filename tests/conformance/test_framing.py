"""Frames that are broken, cut, joined, or lost among noise."""

import random
from typing import TYPE_CHECKING

import pytest

from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import RequestType
from usmbench.instruments.protocol.frames import encode_frame

if TYPE_CHECKING:
    from tests.conformance.conftest import BenchHost, Host

HEARTBEAT = encode_frame(77, RequestType.HEARTBEAT, b"")


def test_any_flipped_bit_is_counted_and_not_answered(bench_host: "BenchHost") -> None:
    bench_host.ask(RequestType.IDENTIFY)
    frame = bench_host.frame(RequestType.SET_DRIVE, 440_000, 100)
    bench_host.new_words()
    bad_frames = bench_host.status().bad_frames
    for position in range(8 * (len(frame) - 1)):
        broken = bytearray(frame)
        broken[position // 8] ^= 1 << position % 8
        assert bench_host.exchange(bytes(broken)) == []
        # A byte that becomes 0 cuts the frame into two bad ones, or one where nothing is left.
        parts = [part for part in bytes(broken).split(b"\0") if part]
        bad_frames += len(parts)
        assert bench_host.status().bad_frames == bad_frames
    assert bench_host.new_words() == []


@pytest.mark.parametrize(
    "chunk",
    [
        b"\x01",
        b"\x02\x41",
        b"\x03\x07\x06",
        b"\xff",
        b"\x05ABC",
        b"\x01" * 36,
        b"\x01" * 37,
        b"\x01" * 38,
        b"\x25" + b"A" * 36,
        b"\x26" + b"A" * 37,
        b"\xff" + b"A" * 254,
        b"\xff" + b"A" * 254 + b"\x05ABCD",
        b"A" * 700,
    ],
)
def test_what_is_no_frame_counts_once(host: "Host", chunk: bytes) -> None:
    host.ask(RequestType.IDENTIFY)
    before = host.status().bad_frames
    assert host.exchange(chunk + b"\0") == []
    assert host.status().bad_frames == before + 1


def test_nothing_between_delimiters_is_nothing(host: "Host") -> None:
    host.ask(RequestType.IDENTIFY)
    before = host.status().bad_frames
    assert host.exchange(bytes(40)) == []
    assert host.status().bad_frames == before


@pytest.mark.parametrize("length", [0, 1, 31, 32])
def test_frames_of_every_size_are_taken(host: "Host", length: int) -> None:
    for fill in (b"\0", b"\xff", b"\x01"):
        reply = host.ask_raw(encode_frame(5, 0x3F, fill * length))
        assert (reply.sequence, reply.type) == (5, 0x3F | wire.REFUSAL_BITS)


@pytest.mark.parametrize("pause_s", [0.0001, 0.02])
def test_a_frame_may_come_byte_by_byte(host: "Host", pause_s: float) -> None:
    host.ask(RequestType.IDENTIFY)
    for byte in HEARTBEAT[:-1]:
        host.line.send(bytes([byte]))
        host.line.wait(pause_s)
    assert host.ask_raw(HEARTBEAT[-1:]).sequence == 77


@pytest.mark.parametrize("count", [2, 5, 20])
def test_frames_may_follow_each_other_at_once(host: "Host", count: int) -> None:
    host.ask(RequestType.IDENTIFY)
    frames = [host.frame(RequestType.SET_DRIVE, 440_000 + k, k) for k in range(count)]
    first = host.sequence - count + 1
    replies = host.exchange(b"".join(frames))
    assert [reply.sequence for reply in replies] == list(range(first, first + count))
    assert all(reply.acknowledged for reply in replies)
    assert host.status().frequency_word_a == 440_000 + count - 1


def test_in_step_again_after_noise(host: "Host") -> None:
    host.ask(RequestType.IDENTIFY)
    noise = random.Random(3)
    for length in (1, 5, 40, 200):
        host.exchange(bytes(noise.randrange(256) for _ in range(length)))
        assert host.ask_raw(b"\0" + HEARTBEAT).sequence == 77


def test_noise_that_touches_a_frame_costs_that_frame_only(host: "Host") -> None:
    host.ask(RequestType.IDENTIFY)
    before = host.status().bad_frames
    assert host.exchange(b"\x33" + HEARTBEAT) == []
    assert host.ask_raw(HEARTBEAT).sequence == 77
    assert host.status().bad_frames == before + 1
