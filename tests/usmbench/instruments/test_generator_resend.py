"""Replies that are lost, late or spoilt: the driver asks again, and is not put off."""

from typing import Any

import pytest

from board_script import DRIVING, acknowledged, phase
from usmbench.errors import BoardError
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol._generated import RequestType

SPOILT = bytearray(phase(3, 512)[1])
SPOILT[2] ^= 0x10

LATE_OR_WRONG = {
    "lost": b"",
    "spoilt": bytes(SPOILT),
    "half": phase(3, 512)[1][:4],
    "noise": b"\x55\xaa\x00\x13\x00",
    "another sequence": acknowledged(2, RequestType.SET_PHASE, DRIVING),
    "another command": acknowledged(3, RequestType.HEARTBEAT, DRIVING),
}


@pytest.mark.parametrize("first", LATE_OR_WRONG.values(), ids=LATE_OR_WRONG.keys())
def test_a_request_without_its_reply_is_sent_again_under_the_same_number(
    generator: SignalGenerator, port: Any, first: bytes
) -> None:
    out, reply = phase(3, 512)
    port.expect((out, first), (b"\0" + out, b"\0" + reply), phase(4, 513))
    start_s = port.now_s
    generator.phase_deg = 45.0
    assert port.now_s - start_s == pytest.approx(0.05)
    generator.phase_deg = 45.09
    assert port.steps == []


@pytest.mark.parametrize(
    "extra",
    [phase(3, 512)[1], b"\x07\x07\x00", b"\x00\x00", b"\x01" * 500 + b"\0"],
    ids=["doubled", "noise", "zeros", "babble"],
)
def test_what_comes_after_a_reply_does_not_disturb_the_next(
    generator: SignalGenerator, port: Any, extra: bytes
) -> None:
    out, reply = phase(3, 512)
    port.expect((out, reply + extra), phase(4, 0))
    start_s = port.now_s
    generator.phase_deg = 45.0
    generator.phase_deg = 0.0
    assert port.now_s == start_s


def test_a_silent_board_is_an_error_after_five_deadlines(
    generator: SignalGenerator, port: Any
) -> None:
    out, _ = phase(3, 512)
    port.expect((out, b""), *[(b"\0" + out, b"")] * 4)
    start_s = port.now_s
    with pytest.raises(BoardError, match=r"/dev/script did not answer set_phase .* 1 s silence"):
        generator.phase_deg = 45.0
    assert port.now_s - start_s == pytest.approx(0.25)


def test_a_reply_that_comes_after_all_tries_is_passed_over(
    generator: SignalGenerator, port: Any
) -> None:
    out, reply = phase(3, 512)
    port.expect((out, b""), *[(b"\0" + out, b"")] * 4)
    with pytest.raises(BoardError):
        generator.phase_deg = 45.0
    out_next, reply_next = phase(4, 100)
    port.expect((b"\0" + out_next, reply + reply + reply_next))
    generator.phase_deg = 100 * 360 / 4096
