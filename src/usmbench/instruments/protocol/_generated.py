"""The wire in numbers. Made from firmware/protocol.yaml by firmware/generate.py."""

from enum import IntEnum, IntFlag
from typing import Final

PROTOCOL_VERSION: Final = 1
BAUD: Final = 115200
BITS_PER_BYTE: Final = 10
DELIMITER: Final = 0x00
CRC_POLYNOMIAL: Final = 0x1021
CRC_INITIAL: Final = 0xFFFF
CRC_CHECK: Final = 0x29B1
MAX_PAYLOAD: Final = 32
ACK_BIT: Final = 0x80
REFUSAL_BITS: Final = 0xC0
DDS_CLOCK_HZ: Final = 25000000
DDS_FREQUENCY_BITS: Final = 28
DDS_PHASE_BITS: Final = 12
FREQUENCY_WORD_MIN: Final = 429497
FREQUENCY_WORD_MAX: Final = 450972
PHASE_WORD_MIN: Final = -2048
PHASE_WORD_MAX: Final = 2048
HOST_SILENCE_MS: Final = 1000


class Flags(IntFlag):
    OUTPUTS_ON = 0x01
    CONFIGURED = 0x02
    HOST_SILENCE = 0x04
    NOT_IDENTIFIED = 0x08
    INTERNAL_FAULT = 0x10


class RequestType(IntEnum):
    IDENTIFY = 0x01
    SET_DRIVE = 0x02
    SET_PHASE = 0x03
    OUTPUTS = 0x04
    STATUS = 0x05
    HEARTBEAT = 0x06


class Refusal(IntEnum):
    UNKNOWN_COMMAND = 0x01
    WRONG_LENGTH = 0x02
    FREQUENCY_OUT_OF_RANGE = 0x03
    PHASE_OUT_OF_RANGE = 0x04
    NOT_CONFIGURED = 0x05
    NOT_IDENTIFIED = 0x06
    BAD_VALUE = 0x07
    INTERNAL_FAULT = 0x08


class ResetCause(IntEnum):
    POWER_ON = 0x00
    BROWN_OUT = 0x01
    WATCHDOG = 0x02
    EXTERNAL = 0x03
    SOFTWARE = 0x04
    STACK = 0x05


class Faults(IntFlag):
    UART_OVERRUN = 0x01
    STACK = 0x02
    DDS_MISMATCH = 0x04
    BROWN_OUT = 0x08
    STATE = 0x10


# Name and struct code of each field; little-endian, no padding.
Layout = tuple[tuple[str, str], ...]

REQUEST_LAYOUTS: Final[dict[RequestType, Layout]] = {
    RequestType.IDENTIFY: (),
    RequestType.SET_DRIVE: (
        ("frequency_word", "I"),
        ("phase_word", "h"),
    ),
    RequestType.SET_PHASE: (("phase_word", "h"),),
    RequestType.OUTPUTS: (("on", "B"),),
    RequestType.STATUS: (),
    RequestType.HEARTBEAT: (),
}

REPLY_LAYOUTS: Final[dict[RequestType, Layout]] = {
    RequestType.IDENTIFY: (
        ("flags", "B"),
        ("protocol_version", "B"),
        ("firmware_major", "B"),
        ("firmware_minor", "B"),
        ("clock_hz", "I"),
        ("frequency_word_min", "I"),
        ("frequency_word_max", "I"),
        ("phase_word_min", "h"),
        ("phase_word_max", "h"),
        ("frequency_bits", "B"),
        ("phase_bits", "B"),
        ("host_silence_ms", "H"),
    ),
    RequestType.SET_DRIVE: (("flags", "B"),),
    RequestType.SET_PHASE: (("flags", "B"),),
    RequestType.OUTPUTS: (("flags", "B"),),
    RequestType.STATUS: (
        ("flags", "B"),
        ("reset_cause", "B"),
        ("faults", "B"),
        ("frequency_word_a", "I"),
        ("frequency_word_b", "I"),
        ("phase_word_a", "H"),
        ("phase_word_b", "H"),
        ("bad_frames", "H"),
        ("silence_trips", "B"),
    ),
    RequestType.HEARTBEAT: (("flags", "B"),),
}
