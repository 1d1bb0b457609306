"""The generator driver against a table of bytes out and bytes in."""

import io
import struct
from collections.abc import Callable
from typing import Any

import pytest

from usmbench.errors import (
    BenchError,
    BoardError,
    BoardRefusedError,
    BoardResetError,
    InputError,
    PortError,
)
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import Flags, Refusal, RequestType
from usmbench.instruments.protocol.frames import encode_frame
from usmbench.instruments.protocol.messages import pack_request

NewPort = Callable[..., Any]

IDENTIFY = bytes.fromhex("00 05 01 01 1F 3E 00")
IDENTITY = bytes.fromhex(
    "03 01 81 03 01 01 08 40 78 7D 01 B9 8D 06 04 9C E1 06 01 02 F8 08 08 1C 0C E8 03 56 46 00"
)
READY = Flags.CONFIGURED
DRIVING = Flags.CONFIGURED | Flags.OUTPUTS_ON
KHZ_41 = 440234


def asked(sequence: int, kind: RequestType, *values: int) -> bytes:
    return encode_frame(sequence, kind, pack_request(kind, *values))


def acknowledged(sequence: int, kind: RequestType, flags: int, rest: bytes = b"") -> bytes:
    return encode_frame(sequence, kind | wire.ACK_BIT, bytes((flags,)) + rest)


def refused(sequence: int, kind: RequestType, reason: Refusal, flags: int) -> bytes:
    return encode_frame(sequence, kind | wire.REFUSAL_BITS, bytes((reason, flags)))


def status(
    sequence: int,
    flags: int,
    *,
    cause: int = 0,
    faults: int = 0,
    words: tuple[int, int] = (KHZ_41, 0),
) -> bytes:
    frequency, phase = words
    rest = struct.pack("<BBIIHHHB", cause, faults, frequency, frequency, 0, phase & 0xFFF, 0, 0)
    return acknowledged(sequence, RequestType.STATUS, flags, rest)


CONNECT = (
    (IDENTIFY, IDENTITY),
    (asked(2, RequestType.OUTPUTS, 0), acknowledged(2, RequestType.OUTPUTS, 0)),
)


def connect(port: Any, **options: Any) -> SignalGenerator:
    settings: dict[str, Any] = {
        "clock": port.clock,
        "frequency_limits_hz": (40_000.0, 42_000.0),
        "phase_limits_deg": (-180.0, 180.0),
    }
    return SignalGenerator(port, **(settings | options))


@pytest.fixture
def port(scripted_port: NewPort) -> Any:
    return scripted_port(*CONNECT)


@pytest.fixture
def generator(port: Any) -> SignalGenerator:
    return connect(port)


def phase(sequence: int, word: int, flags: int = DRIVING) -> tuple[bytes, bytes]:
    kind = RequestType.SET_PHASE
    return asked(sequence, kind, word), acknowledged(sequence, kind, flags)


def test_session_of_the_protocol_document(generator: SignalGenerator, port: Any) -> None:
    """Bytes written by hand, so that codec and driver are not checked against themselves only."""
    assert generator.identity.host_silence_ms == 1000
    set_drive = asked(3, RequestType.SET_DRIVE, KHZ_41, 1024)
    port.expect(
        (set_drive, acknowledged(3, RequestType.SET_DRIVE, READY)),
        (bytes.fromhex("03 04 03 04 FC F2 39 00"), bytes.fromhex("06 04 83 03 F4 6E 00")),
    )
    generator.set_drive(41_000.0, 90.0)
    generator.phase_deg = -90.0
    assert generator.phase_deg == -90.0
    assert generator.frequency_hz == pytest.approx(41_000.0, abs=0.047)
    assert port.steps == []


def test_what_is_read_back_is_what_the_chip_can_produce(
    generator: SignalGenerator, port: Any
) -> None:
    port.expect(
        (asked(3, RequestType.STATUS), status(3, 0, words=(KHZ_41, 0))),
        (
            asked(4, RequestType.SET_DRIVE, 429497, 0),
            acknowledged(4, RequestType.SET_DRIVE, READY),
        ),
        phase(5, 114, READY),
    )
    generator.frequency_hz = 40_000.0
    generator.phase_deg = 10.0
    assert generator.frequency_hz == 429497 * 25e6 / 2**28
    assert generator.phase_deg == 114 * 360 / 4096


@pytest.mark.parametrize(
    ("values", "match"),
    [
        ((39_999.9, 0.0), r"frequency 39999.9 Hz is outside this lab's .*frequency_limits_hz"),
        ((float("nan"), 0.0), "frequency nan"),
        ((41_000.0, 180.1), r"phase 180.1° is outside this lab's .*phase_limits_deg"),
        ((41_000.0, float("-inf")), "phase -inf"),
    ],
)
def test_a_value_outside_the_labs_limits_is_refused_before_a_byte_is_sent(
    generator: SignalGenerator, values: tuple[float, float], match: str
) -> None:
    with pytest.raises(InputError, match=match):
        generator.set_drive(*values)


def test_a_value_outside_the_boards_limits_is_refused_before_a_byte_is_sent(port: Any) -> None:
    generator = connect(port, frequency_limits_hz=(1.0, 1e6), phase_limits_deg=(-720.0, 720.0))
    with pytest.raises(InputError, match=r"43000.0 Hz is outside what the board takes, 40000.0 to"):
        generator.set_drive(43_000.0, 0.0)
    with pytest.raises(InputError, match=r"phase 181.0° .* -180.0 to 180.0"):
        generator.phase_deg = 181.0


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


@pytest.mark.parametrize("reason", set(Refusal) - {Refusal.NOT_IDENTIFIED})
def test_every_refusal_has_its_name_and_a_mend(
    generator: SignalGenerator, port: Any, reason: Refusal
) -> None:
    out = asked(3, RequestType.SET_PHASE, 512)
    port.expect((out, refused(3, RequestType.SET_PHASE, reason, READY)))
    name = reason.name.lower()
    with pytest.raises(BoardRefusedError, match=rf"refused set_phase \({name}\): \w+") as caught:
        generator.phase_deg = 45.0
    assert caught.value.reason == name


NOT_IDENTIFIED = Flags.NOT_IDENTIFIED


@pytest.mark.parametrize(
    "reply",
    [
        refused(3, RequestType.HEARTBEAT, Refusal.NOT_IDENTIFIED, NOT_IDENTIFIED),
        acknowledged(3, RequestType.HEARTBEAT, NOT_IDENTIFIED),
    ],
    ids=["refusal", "flag"],
)
def test_a_reset_is_reported_with_its_cause(
    generator: SignalGenerator, port: Any, reply: bytes
) -> None:
    port.expect(
        (asked(3, RequestType.HEARTBEAT), reply),
        (asked(4, RequestType.STATUS), status(4, NOT_IDENTIFIED, cause=2, words=(0, 0))),
    )
    with pytest.raises(BoardResetError, match=r"restarted \(cause: watchdog\)"):
        generator.heartbeat()


def test_host_silence_and_internal_faults_are_reported(
    generator: SignalGenerator, port: Any
) -> None:
    kind = RequestType.HEARTBEAT
    port.expect((asked(3, kind), acknowledged(3, kind, READY | Flags.HOST_SILENCE)))
    with pytest.raises(BoardError, match="heard nothing"):
        generator.heartbeat()
    port.expect(
        (asked(4, kind), acknowledged(4, kind, Flags.INTERNAL_FAULT)),
        (asked(5, RequestType.STATUS), status(5, Flags.INTERNAL_FAULT, faults=4)),
    )
    with pytest.raises(BoardError, match=r"internal fault \(dds_mismatch\)"):
        generator.heartbeat()


def test_outputs(generator: SignalGenerator, port: Any) -> None:
    kind = RequestType.OUTPUTS
    port.expect(
        (asked(3, kind, 1), acknowledged(3, kind, DRIVING)),
        (asked(4, RequestType.STATUS), status(4, DRIVING)),
        (asked(5, kind, 0), acknowledged(5, kind, READY | Flags.INTERNAL_FAULT)),
        (asked(6, kind, 1), acknowledged(6, kind, READY)),
    )
    generator.outputs_on = True
    assert generator.outputs_on
    generator.outputs_on = False
    with pytest.raises(BoardError, match="acknowledged outputs on but they are off"):
        generator.outputs_on = True
    port.expect((asked(7, kind, 0), acknowledged(7, kind, DRIVING)))
    with pytest.raises(BoardError, match="cut the power"):
        generator.off()


@pytest.mark.parametrize("step", ["write", "read"])
@pytest.mark.parametrize("n_before", [0, 1])
def test_a_port_that_goes_while_connecting(
    scripted_port: NewPort, step: str, n_before: int
) -> None:
    gone = OSError(5, "Input/output error")
    broken = gone if step == "write" else (CONNECT[n_before][0], gone)
    with pytest.raises(PortError, match=r"/dev/script has gone .*Input/output error"):
        connect(scripted_port(*CONNECT[:n_before], broken))


@pytest.mark.parametrize("step", ["write", "read"])
def test_a_port_that_goes_in_use_is_opened_anew_to_switch_off(
    scripted_port: NewPort, port: Any, step: str
) -> None:
    gone = OSError(5, "Input/output error")
    out, _ = phase(3, 512)
    again = scripted_port(
        (b"\0" + asked(5, RequestType.IDENTIFY), _identity(5)),
        (asked(6, RequestType.OUTPUTS, 0), acknowledged(6, RequestType.OUTPUTS, 0)),
    )
    generator = connect(port, reopen=lambda: again)
    port.expect(gone if step == "write" else (out, gone), gone)
    with pytest.raises(PortError) as caught, generator:
        generator.phase_deg = 45.0
    assert again.steps == []
    assert port.closed
    assert again.closed
    assert not hasattr(caught.value, "__notes__")


def _identity(sequence: int, **changes: int) -> bytes:
    names = [name for name, _ in wire.REPLY_LAYOUTS[RequestType.IDENTIFY]]
    codes = "".join(code for _, code in wire.REPLY_LAYOUTS[RequestType.IDENTIFY])
    usual = (0, 1, 1, 0, 25_000_000, 429497, 450972, -2048, 2048, 28, 12, 1000)
    values = {**dict(zip(names, usual, strict=True)), **changes}
    payload = struct.pack("<" + codes, *values.values())
    return encode_frame(sequence, RequestType.IDENTIFY | wire.ACK_BIT, payload)


@pytest.mark.parametrize(
    ("identity", "match"),
    [
        (_identity(1, protocol_version=2), "version 2 of the protocol, .* version 1: update"),
        (_identity(1, protocol_version=0), "version 0 of the protocol, .* version 1: flash"),
        (acknowledged(1, RequestType.IDENTIFY, 0, b"\x07more"), "version 7"),
        (_identity(1, clock_hz=16_000_000), "16000000 Hz clock"),
        (_identity(1, phase_bits=10), "10 phase bits"),
    ],
)
def test_another_board_is_wrong_input_and_nothing_moves(
    scripted_port: NewPort, identity: bytes, match: str
) -> None:
    with pytest.raises(InputError, match=match):
        connect(scripted_port((IDENTIFY, identity)))


def test_a_board_with_a_fault_is_not_driven(scripted_port: NewPort) -> None:
    port = scripted_port(
        (IDENTIFY, _identity(1, flags=Flags.INTERNAL_FAULT)),
        CONNECT[1],
        (asked(3, RequestType.STATUS), status(3, Flags.INTERNAL_FAULT, faults=2)),
    )
    with pytest.raises(BoardError, match=r"internal fault \(stack\)"):
        connect(port)


OFF = RequestType.OUTPUTS


def off(sequence: int, *, resend: bool = False) -> tuple[bytes, bytes]:
    return b"\0" * resend + asked(sequence, OFF, 0), acknowledged(sequence, OFF, 0)


@pytest.mark.parametrize("error", [ValueError("ours"), KeyboardInterrupt(), BoardError("its")])
def test_the_context_switches_off_after_any_error(
    generator: SignalGenerator, port: Any, error: BaseException
) -> None:
    port.expect(off(3))
    with pytest.raises(type(error)) as caught, generator:
        raise error
    assert caught.value is error
    assert port.steps == []
    assert port.closed


def test_the_context_switches_off_without_an_error(generator: SignalGenerator, port: Any) -> None:
    port.expect(off(3))
    with generator:
        pass
    assert port.steps == []
    assert port.closed


@pytest.mark.parametrize("step", ["write", "read"])
def test_ctrl_c_inside_an_exchange_leaves_the_next_one_sound(
    generator: SignalGenerator, port: Any, step: str
) -> None:
    """The reply to the exchange that was broken off arrives first, and is not taken for ours."""
    out, reply = phase(3, 512)
    port.expect(KeyboardInterrupt() if step == "write" else (out, KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        generator.phase_deg = 45.0
    port.expect(
        (b"\0" + asked(4, RequestType.STATUS), reply + status(4, DRIVING, words=(KHZ_41, 512)))
    )
    assert generator.phase_deg == 45.0


def test_a_second_ctrl_c_while_switching_off_does_not_leave_the_drive_on(
    generator: SignalGenerator, port: Any
) -> None:
    port.expect(KeyboardInterrupt(), off(4, resend=True))
    with pytest.raises(KeyboardInterrupt), generator:
        pass
    assert port.steps == []
    assert port.closed


def test_ctrl_c_with_the_board_gone_is_reported_as_the_failure_it_is(
    generator: SignalGenerator, port: Any
) -> None:
    gone = OSError(5, "Input/output error")
    port.expect(gone)
    # Without a way to open the port again each further attempt identifies on the same port.
    port.steps += [gone, gone]
    with pytest.raises(PortError, match="1 s silence watchdog"), generator:
        raise KeyboardInterrupt
    assert port.closed


def test_another_error_with_the_board_gone_says_so_in_a_note(
    generator: SignalGenerator, port: Any
) -> None:
    gone = OSError(5, "Input/output error")
    port.expect(gone, gone, gone)
    with pytest.raises(ValueError, match="ours") as caught, generator:
        raise ValueError("ours")
    assert "1 s silence watchdog" in caught.value.__notes__[0]


def test_the_frame_log_has_every_exchange(port: Any) -> None:
    log = io.StringIO()
    generator = connect(port, frame_log=log)
    out, reply = phase(3, 512)
    port.expect((out, b"\x05\x00"), (b"\0" + out, reply))
    generator.phase_deg = 45.0
    lines = log.getvalue().splitlines()
    assert lines[0] == f"    0.000000 > {IDENTIFY.hex(' ')}  identify sequence=1"
    assert "ack identify sequence=1 flags=0 protocol_version=1" in lines[1]
    assert lines[-4].endswith("set_phase sequence=3 phase_word=512")
    assert lines[-3] == "    0.050000 < 05 00  bad frames: 1"
    assert lines[-1].endswith("ack set_phase sequence=3 flags=outputs_on|configured")


def test_a_frame_log_without_room_does_not_keep_the_drive_on(port: Any) -> None:
    class Full(io.StringIO):
        full = False

        def write(self, text: str) -> int:
            if self.full:
                raise OSError(28, "No space left on device")
            return super().write(text)

    log = Full()
    generator = connect(port, frame_log=log)
    log.full = True
    # Each attempt reaches the board before its line cannot be written.
    port.expect(off(3), off(4, resend=True), off(5, resend=True))
    with pytest.raises(BenchError, match="No space left"), generator:
        pass
    assert port.closed


def test_after_256_requests_the_sequence_starts_over(generator: SignalGenerator, port: Any) -> None:
    kind = RequestType.HEARTBEAT
    numbers = [*range(3, 256), *range(4)]
    port.expect(*[(asked(n, kind), acknowledged(n, kind, 0)) for n in numbers])
    for _ in numbers:
        generator.heartbeat()
    assert port.steps == []
