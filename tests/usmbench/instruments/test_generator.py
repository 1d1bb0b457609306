"""What the generator driver sets and reads, as a table of bytes out and bytes in."""

import io
from typing import Any

import pytest

from board_script import (
    DRIVING,
    IDENTIFY,
    KHZ_41,
    READY,
    acknowledged,
    asked,
    connect,
    phase,
    status,
)
from usmbench.errors import BoardError, InputError
from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol._generated import Flags, RequestType


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


def test_after_256_requests_the_sequence_starts_over(generator: SignalGenerator, port: Any) -> None:
    kind = RequestType.HEARTBEAT
    numbers = [*range(3, 256), *range(4)]
    port.expect(*[(asked(n, kind), acknowledged(n, kind, 0)) for n in numbers])
    for _ in numbers:
        generator.heartbeat()
    assert port.steps == []


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
