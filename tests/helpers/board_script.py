"""The bytes of a session between the generator driver and a board, as the protocol has them."""

import struct
from typing import Any

from usmbench.instruments.generator import SignalGenerator
from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import Flags, Refusal, RequestType
from usmbench.instruments.protocol.frames import encode_frame
from usmbench.instruments.protocol.messages import pack_request

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


def phase(sequence: int, word: int, flags: int = DRIVING) -> tuple[bytes, bytes]:
    kind = RequestType.SET_PHASE
    return asked(sequence, kind, word), acknowledged(sequence, kind, flags)


def off(sequence: int, *, resend: bool = False) -> tuple[bytes, bytes]:
    kind = RequestType.OUTPUTS
    return b"\0" * resend + asked(sequence, kind, 0), acknowledged(sequence, kind, 0)


def identity(sequence: int, **changes: int) -> bytes:
    names = [name for name, _ in wire.REPLY_LAYOUTS[RequestType.IDENTIFY]]
    codes = "".join(code for _, code in wire.REPLY_LAYOUTS[RequestType.IDENTIFY])
    usual = (0, 1, 1, 0, 25_000_000, 429497, 450972, -2048, 2048, 28, 12, 1000)
    values = {**dict(zip(names, usual, strict=True)), **changes}
    payload = struct.pack("<" + codes, *values.values())
    return encode_frame(sequence, RequestType.IDENTIFY | wire.ACK_BIT, payload)


def connect(port: Any, **options: Any) -> SignalGenerator:
    settings: dict[str, Any] = {
        "clock": port.clock,
        "frequency_limits_hz": (40_000.0, 42_000.0),
        "phase_limits_deg": (-180.0, 180.0),
    }
    return SignalGenerator(port, **(settings | options))
