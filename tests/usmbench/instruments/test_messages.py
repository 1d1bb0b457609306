"""Messages: fields in the generated order, strict lengths, words for the frame log."""

import struct
from collections.abc import Callable
from dataclasses import fields
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from usmbench.errors import BoardError
from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol import messages
from usmbench.instruments.protocol.frames import Frame

STATUS = struct.pack("<BBBIIHHHB", 3, 2, 5, 440234, 440234, 0, 3072, 7, 1)


@pytest.mark.parametrize(
    ("kind", "of"),
    [
        (messages.Identity, wire.RequestType.IDENTIFY),
        (messages.Status, wire.RequestType.STATUS),
    ],
)
def test_dataclasses_have_the_fields_of_the_wire(kind: Any, of: wire.RequestType) -> None:
    assert [field.name for field in fields(kind)] == [name for name, _ in wire.REPLY_LAYOUTS[of]]


def test_status() -> None:
    status = messages.unpack_status(STATUS)
    assert status == messages.Status(
        flags=wire.Flags.OUTPUTS_ON | wire.Flags.CONFIGURED,
        reset_cause=wire.ResetCause.WATCHDOG,
        faults=wire.Faults.UART_OVERRUN | wire.Faults.DDS_MISMATCH,
        frequency_word_a=440234,
        frequency_word_b=440234,
        phase_word_a=0,
        phase_word_b=3072,
        bad_frames=7,
        silence_trips=1,
    )


def test_requests_are_little_endian() -> None:
    payload = messages.pack_request(wire.RequestType.SET_DRIVE, 0x01020304, -2)
    assert payload == bytes((4, 3, 2, 1, 0xFE, 0xFF))


@pytest.mark.parametrize(
    ("unpack", "size"),
    [
        (messages.unpack_identity, 24),
        (messages.unpack_status, 18),
        (messages.unpack_refusal, 2),
        (lambda payload: messages.unpack_flags(wire.RequestType.OUTPUTS, payload), 1),
    ],
)
def test_only_the_right_length_is_taken(unpack: Callable[[bytes], object], size: int) -> None:
    unpack(bytes((1, *bytes(size - 1))))
    for wrong in (size - 1, size + 1):
        with pytest.raises(BoardError, match=f"has {wrong} bytes where {size} are due"):
            unpack(bytes(wrong))


def test_unknown_causes_and_reasons_are_errors_of_the_board() -> None:
    with pytest.raises(BoardError, match="reset cause 99"):
        messages.unpack_status(STATUS[:1] + b"\x63" + STATUS[2:])
    with pytest.raises(BoardError, match="reason 99"):
        messages.unpack_refusal(b"\x63\0")


@pytest.mark.parametrize(
    ("frame", "text"),
    [
        (Frame(7, 0x03, b"\0\xfc"), "set_phase sequence=7 phase_word=-1024"),
        (Frame(7, 0x83, b"\x03"), "ack set_phase sequence=7 flags=outputs_on|configured"),
        (
            Frame(7, 0xC3, b"\x04\0"),
            "refusal set_phase sequence=7 reason=phase_out_of_range flags=0",
        ),
        (Frame(7, 0xC3, b"\x63\0"), "refusal set_phase sequence=7 reason=99 flags=0"),
        (Frame(7, 0x33, b"\x01\x02"), "type 0x33 sequence=7 payload=01 02"),
        (Frame(7, 0x03, b"\x01"), "set_phase sequence=7 payload=01"),
    ],
)
def test_the_log_says_what_a_frame_means(frame: Frame, text: str) -> None:
    assert messages.describe(frame) == text


@given(st.integers(0, 255), st.integers(0, 255), st.binary(max_size=32))
def test_any_frame_can_be_described(sequence: int, frame_type: int, payload: bytes) -> None:
    assert f"sequence={sequence}" in messages.describe(Frame(sequence, frame_type, payload))
