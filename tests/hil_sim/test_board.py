"""The emulated board, request by request, as firmware/PROTOCOL.md has it."""

import struct
from collections.abc import Sequence
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_sim.board import TURN_AROUND_S, Board
from hil_sim.line import BYTE_S
from hil_sim.signals import Drive
from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import Flags, Refusal, RequestType, ResetCause
from usmbench.instruments.protocol.frames import Frame, FrameReader, encode_frame
from usmbench.instruments.protocol.messages import (
    Status,
    pack_request,
    unpack_flags,
    unpack_identity,
    unpack_refusal,
    unpack_status,
)

OFF = Drive()
HZ_PER_WORD = 25e6 / 2**28


class Host:
    """Talks to a board, one frame every `gap_s`."""

    def __init__(self, board: Board | None = None, *, identified: bool = True):
        self.board = Board() if board is None else board
        self.time_s = 0.0
        self.sequence = 0
        if identified:
            self.ask(RequestType.IDENTIFY)

    def send(self, data: bytes) -> list[Frame]:
        for byte in data:
            self.time_s += BYTE_S
            self.board.receive(byte, self.time_s)
        frames = FrameReader().feed(b"".join(frame for _, frame in self.board.replies))
        self.board.replies.clear()
        return frames

    def frame(self, kind: RequestType, *values: int) -> bytes:
        self.sequence = (self.sequence + 1) % 256
        return encode_frame(self.sequence, kind, pack_request(kind, *values))

    def ask(self, kind: RequestType, *values: int) -> Flags:
        (reply,) = self.send(self.frame(kind, *values))
        assert reply.type == kind | wire.ACK_BIT
        assert reply.sequence == self.sequence
        return unpack_flags(kind, reply.payload)

    def refused(self, kind: int, payload: bytes) -> Refusal:
        self.sequence = (self.sequence + 1) % 256
        (reply,) = self.send(encode_frame(self.sequence, kind, payload))
        assert (reply.sequence, reply.type) == (self.sequence, kind | wire.REFUSAL_BITS)
        return unpack_refusal(reply.payload)[0]

    def status(self) -> Status:
        (reply,) = self.send(self.frame(RequestType.STATUS))
        return unpack_status(reply.payload)

    def run(self, frequency_word: int = 440_000, phase_word: int = 1024) -> None:
        self.ask(RequestType.SET_DRIVE, frequency_word, phase_word)
        self.ask(RequestType.OUTPUTS, 1)

    @property
    def drive(self) -> Drive:
        return self.board.drive_changes[-1][1] if self.board.drive_changes else OFF


def test_identify_says_who_it_is_and_lets_commands_in() -> None:
    host = Host(identified=False)
    assert Flags(host.status().flags) == Flags.NOT_IDENTIFIED
    (reply,) = host.send(host.frame(RequestType.IDENTIFY))
    identity = unpack_identity(reply.payload)
    assert identity.protocol_version == wire.PROTOCOL_VERSION
    assert identity.clock_hz == wire.DDS_CLOCK_HZ
    assert identity.frequency_word_max == wire.FREQUENCY_WORD_MAX
    assert identity.phase_word_min == wire.PHASE_WORD_MIN
    assert identity.host_silence_ms == wire.HOST_SILENCE_MS
    assert Flags(host.status().flags) == Flags(0)


def test_the_reply_starts_a_turn_around_after_the_request() -> None:
    host = Host()
    for byte in host.frame(RequestType.HEARTBEAT):
        host.time_s += BYTE_S
        host.board.receive(byte, host.time_s)
    assert [start_s for start_s, _ in host.board.replies] == [host.time_s + TURN_AROUND_S]


@pytest.mark.parametrize(
    ("kind", "payload", "reason"),
    [
        (0x07, b"", Refusal.UNKNOWN_COMMAND),
        (0x00, b"", Refusal.UNKNOWN_COMMAND),
        (0x7F, b"\1\2\3", Refusal.UNKNOWN_COMMAND),
        (RequestType.IDENTIFY, b"\0", Refusal.WRONG_LENGTH),
        (RequestType.SET_DRIVE, bytes(5), Refusal.WRONG_LENGTH),
        (RequestType.SET_PHASE, bytes(3), Refusal.WRONG_LENGTH),
        (RequestType.OUTPUTS, b"", Refusal.WRONG_LENGTH),
        (RequestType.STATUS, b"\0", Refusal.WRONG_LENGTH),
        (RequestType.HEARTBEAT, b"\0", Refusal.WRONG_LENGTH),
        (RequestType.SET_DRIVE, struct.pack("<Ih", 429_496, 0), Refusal.FREQUENCY_OUT_OF_RANGE),
        (RequestType.SET_DRIVE, struct.pack("<Ih", 450_973, 0), Refusal.FREQUENCY_OUT_OF_RANGE),
        (RequestType.SET_DRIVE, struct.pack("<Ih", 0, 3000), Refusal.FREQUENCY_OUT_OF_RANGE),
        (RequestType.SET_DRIVE, struct.pack("<Ih", 440_000, 2049), Refusal.PHASE_OUT_OF_RANGE),
        (RequestType.SET_PHASE, struct.pack("<h", -2049), Refusal.PHASE_OUT_OF_RANGE),
        (RequestType.OUTPUTS, b"\2", Refusal.BAD_VALUE),
        (RequestType.OUTPUTS, b"\1", Refusal.NOT_CONFIGURED),
    ],
)
def test_every_refusal_and_no_effect(kind: int, payload: bytes, reason: Refusal) -> None:
    host = Host()
    before = host.status()
    assert host.refused(kind, payload) is reason
    assert host.status() == before
    assert host.drive == OFF


@pytest.mark.parametrize(
    ("kind", "payload"),
    [
        (RequestType.SET_DRIVE, struct.pack("<Ih", 0, 0)),
        (RequestType.SET_PHASE, struct.pack("<h", 0)),
        (RequestType.OUTPUTS, b"\1"),
        (RequestType.OUTPUTS, b"\2"),
        (RequestType.HEARTBEAT, b""),
    ],
)
def test_a_stranger_may_only_ask_and_switch_off(kind: int, payload: bytes) -> None:
    host = Host(identified=False)
    assert host.refused(kind, payload) is Refusal.NOT_IDENTIFIED
    assert host.ask(RequestType.OUTPUTS, 0) == Flags.NOT_IDENTIFIED


@pytest.mark.parametrize("word", [wire.FREQUENCY_WORD_MIN, wire.FREQUENCY_WORD_MAX])
@pytest.mark.parametrize("phase_word", [wire.PHASE_WORD_MIN, wire.PHASE_WORD_MAX])
def test_the_limits_themselves_are_allowed(word: int, phase_word: int) -> None:
    host = Host()
    host.run(word, phase_word)
    status = host.status()
    assert (status.frequency_word_a, status.frequency_word_b) == (word, word)
    assert (status.phase_word_a, status.phase_word_b) == (0, 2048)
    assert host.drive == Drive(word * HZ_PER_WORD, -180.0, 1.0, 1.0)


def test_a_repeat_has_no_second_effect_and_the_same_answer() -> None:
    host = Host()
    host.run()
    changed = host.frame(RequestType.SET_PHASE, 100)
    (first,) = host.send(changed)
    host.board.drive_changes.clear()
    (again,) = host.send(b"\0" + changed)
    assert again == first
    assert not host.board.drive_changes
    host.ask(RequestType.SET_PHASE, 200)
    assert host.send(changed) == [first]
    assert host.drive.phase_deg == pytest.approx(100 * 360 / 4096)


def test_a_refusal_is_not_remembered() -> None:
    host = Host()
    switch_on = host.frame(RequestType.OUTPUTS, 1)
    (refusal,) = host.send(switch_on)
    assert refusal.type == RequestType.OUTPUTS | wire.REFUSAL_BITS
    host.sequence -= 2
    host.ask(RequestType.SET_DRIVE, 440_000, 0)
    (reply,) = host.send(switch_on)
    assert reply.type == RequestType.OUTPUTS | wire.ACK_BIT


@pytest.mark.parametrize("forgets", ["nothing", "identify", "reset", "silence"])
def test_what_empties_the_memory(forgets: str) -> None:
    words: list[int] = []
    host = Host(Board(spi_log=lambda _time_s, _chips, word: words.append(word)))
    host.run()
    request = host.frame(RequestType.OUTPUTS, 1)
    host.send(request)
    if forgets == "reset":
        host.board.reset(host.time_s, ResetCause.EXTERNAL)
    elif forgets == "identify":
        host.ask(RequestType.IDENTIFY)
    elif forgets == "silence":
        host.time_s += 1.5
        host.board.advance(host.time_s)
    words.clear()
    (reply,) = host.send(request)
    refused = reply.type == RequestType.OUTPUTS | wire.REFUSAL_BITS
    assert refused is (forgets == "reset")
    assert bool(words) is (forgets in ("identify", "silence"))


def test_silence_stops_the_drive_at_its_very_instant() -> None:
    host = Host()
    host.run()
    last_s = host.time_s
    host.board.drive_changes.clear()
    host.board.advance(last_s + 0.999999)
    assert not host.board.drive_changes
    host.board.advance(last_s + 7.0)
    ((trip_s, drive),) = host.board.drive_changes
    assert trip_s == last_s + 1.0
    assert (drive.amplitude_a, drive.amplitude_b) == (0.0, 0.0)
    host.time_s = last_s + 7.0
    status = host.status()
    assert Flags(status.flags) == Flags.HOST_SILENCE | Flags.CONFIGURED
    assert status.silence_trips == 1
    assert host.ask(RequestType.HEARTBEAT) & Flags.HOST_SILENCE
    assert host.ask(RequestType.OUTPUTS, 1) == Flags.CONFIGURED | Flags.OUTPUTS_ON


@pytest.mark.parametrize(
    ("frame", "heard"),
    [
        (encode_frame(9, RequestType.HEARTBEAT, b""), True),
        (encode_frame(9, 0x55, b""), True),
        (encode_frame(9, RequestType.HEARTBEAT | wire.ACK_BIT, b""), False),
        (b"\x05\x01\x01\x1f\x3f\x00", False),
        (encode_frame(9, RequestType.HEARTBEAT, b"")[:-1], False),
    ],
)
def test_what_counts_as_a_word_from_the_host(frame: bytes, heard: bool) -> None:
    host = Host()
    host.run()
    host.time_s += 0.6
    host.send(frame)
    host.board.advance(host.time_s + 0.6)
    assert (host.drive.amplitude_a == 1.0) is heard


def test_replies_on_the_line_are_not_answered() -> None:
    host = Host()
    assert host.send(encode_frame(9, RequestType.HEARTBEAT | wire.ACK_BIT, b"")) == []


@pytest.mark.parametrize("cause", ResetCause)
def test_a_reset_forgets_everything_but_its_cause(cause: ResetCause) -> None:
    host = Host()
    host.run()
    host.send(b"\x01\x00")
    host.send(b"\x05\x09")
    host.board.reset(host.time_s + 0.1, cause)
    assert host.board.drive_changes[-1] == (host.time_s + 0.1, OFF)
    status = host.status()
    assert status.reset_cause == cause
    assert (status.frequency_word_a, status.frequency_word_b) == (0, 0)
    assert (status.phase_word_a, status.phase_word_b) == (0, 0)
    assert status.bad_frames == 0
    assert Flags(status.flags) & Flags.NOT_IDENTIFIED


def test_after_a_stack_fault_the_drive_stays_off() -> None:
    host = Host()
    host.board.reset(host.time_s, ResetCause.STACK)
    assert host.ask(RequestType.IDENTIFY) == Flags.INTERNAL_FAULT
    assert host.status().faults == wire.Faults.STACK
    for kind, payload in (
        (RequestType.SET_DRIVE, struct.pack("<Ih", 440_000, 0)),
        (RequestType.SET_PHASE, struct.pack("<h", 0)),
        (RequestType.OUTPUTS, b"\1"),
    ):
        assert host.refused(kind, payload) is Refusal.INTERNAL_FAULT
    assert host.ask(RequestType.OUTPUTS, 0) == Flags.INTERNAL_FAULT


def test_the_words_on_the_spi_bus_are_those_of_the_protocol_document() -> None:
    words: list[tuple[str, int]] = []
    host = Host(Board(spi_log=lambda _time_s, chips, word: words.append((chips, word))))
    assert words == [
        *(("ab", word) for word in (0x2128, 0x4000, 0x4000, 0x8000, 0x8000, 0xC000, 0xE000))
    ]
    words.clear()
    host.ask(RequestType.SET_DRIVE, 440_234, 1024)
    low, high = 440_234 & 0x3FFF, 440_234 >> 14
    assert words == [("ab", 0x8000 | low), ("ab", 0x8000 | high), ("b", 0xE400), ("ab", 0x2D28)]
    words.clear()
    host.ask(RequestType.OUTPUTS, 1)
    host.ask(RequestType.SET_PHASE, -1024)
    host.ask(RequestType.OUTPUTS, 0)
    host.ask(RequestType.OUTPUTS, 0)
    assert words == [
        ("ab", 0x2C28),
        ("b", 0xCC00),
        ("ab", 0x2828),
        ("ab", 0x2928),
        ("ab", 0x2928),
    ]


COMMANDS = st.one_of(
    st.tuples(
        st.just(RequestType.SET_DRIVE),
        st.integers(wire.FREQUENCY_WORD_MIN, wire.FREQUENCY_WORD_MAX),
        st.integers(wire.PHASE_WORD_MIN, wire.PHASE_WORD_MAX),
    ),
    st.tuples(
        st.just(RequestType.SET_PHASE), st.integers(wire.PHASE_WORD_MIN, wire.PHASE_WORD_MAX)
    ),
    st.tuples(st.just(RequestType.OUTPUTS), st.integers(0, 1)),
    st.tuples(st.just(RequestType.HEARTBEAT)),
)


@settings(deadline=None, max_examples=60)
@given(st.lists(COMMANDS, max_size=25), st.randoms(use_true_random=False))
def test_the_chips_hold_what_was_asked_whatever_is_resent(
    commands: Sequence[tuple[RequestType, *tuple[int, ...]]], chance: Random
) -> None:
    host = Host()
    frequency_word, phase_word, on = 440_000, 0, 0
    host.ask(RequestType.SET_DRIVE, frequency_word, phase_word)
    for kind, *values in commands:
        frame = host.frame(kind, *values)
        for _ in range(chance.randint(1, 3)):
            host.send(frame)
        if kind is RequestType.SET_DRIVE:
            frequency_word, phase_word = values
        elif kind is RequestType.SET_PHASE:
            (phase_word,) = values
        elif kind is RequestType.OUTPUTS:
            (on,) = values
        status = host.status()
        assert status.frequency_word_a == status.frequency_word_b == frequency_word
        assert (status.phase_word_a, status.phase_word_b) == (0, phase_word % 4096)
        assert bool(Flags(status.flags) & Flags.OUTPUTS_ON) is bool(on)
        assert (host.drive.amplitude_a, host.drive.amplitude_b) == (on, on)
        assert host.drive.frequency_hz == frequency_word * HZ_PER_WORD
        assert (host.drive.phase_deg * 4096 / 360 - phase_word) % 4096 == 0


@settings(deadline=None, max_examples=200)
@given(st.lists(st.one_of(st.binary(max_size=50), st.sampled_from([b"\x05\x01\x01\x1f\x3e\x00"]))))
def test_garbage_never_raises_and_the_board_stays_in_step(pieces: list[bytes]) -> None:
    host = Host()
    host.run()
    host.send(b"".join(pieces) + b"\0")
    assert host.ask(RequestType.HEARTBEAT) & Flags.CONFIGURED
