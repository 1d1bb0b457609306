"""The board's side of the framing, a byte at a time as the firmware takes it.

Written apart from the host's codec, so that a mistake in one shows against the other.
"""

from typing import Final

from usmbench.instruments.protocol._generated import (
    CRC_INITIAL,
    CRC_POLYNOMIAL,
    DELIMITER,
    MAX_PAYLOAD,
)

_HEADER_BYTES: Final = 2
_CRC_BYTES: Final = 2
_MIN_CONTENT: Final = _HEADER_BYTES + _CRC_BYTES
_MAX_CONTENT: Final = _MIN_CONTENT + MAX_PAYLOAD
_COUNT_MAX: Final = 0xFFFF


def _crc_of_byte(byte: int) -> int:
    crc = byte << 8
    for _ in range(8):
        crc = (crc << 1 ^ CRC_POLYNOMIAL if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


_CRC_TABLE: Final = tuple(_crc_of_byte(byte) for byte in range(256))


def crc16(data: bytes | bytearray) -> int:
    """Return the CRC-16/IBM-3740 of some bytes.

    Parameters
    ----------
    data
        What the frame carries before its CRC.
    """
    crc = CRC_INITIAL
    for byte in data:
        crc = (crc << 8 & 0xFF00) ^ _CRC_TABLE[crc >> 8 ^ byte]
    return crc


def build_frame(content: bytes) -> bytes:
    """Return the bytes on the line for sequence, type and payload: CRC, COBS and delimiter added.

    Parameters
    ----------
    content
        Sequence, type and payload; with the CRC fewer than 254 bytes.
    """
    checked = content + crc16(content).to_bytes(_CRC_BYTES, "little")
    stuffed = bytearray()
    for group in checked.split(b"\0"):
        stuffed.append(len(group) + 1)
        stuffed += group
    stuffed.append(DELIMITER)
    return bytes(stuffed)


class FrameReceiver:
    """Takes bytes, gives the content of each whole frame, counts the others."""

    def __init__(self) -> None:
        self.bad_frames = 0
        self._restart()

    def _restart(self) -> None:
        self._content = bytearray()
        self._left_in_group = 0
        self._zero_owed = False
        self._began = False
        self._broken = False

    def push(self, byte: int) -> bytes | None:
        """Take one byte; return sequence, type, payload and CRC where it ends a sound frame.

        Parameters
        ----------
        byte
            What came over the line, 0 to 255.
        """
        if byte == DELIMITER:
            return self._end()
        self._began = True
        if len(self._content) > _MAX_CONTENT:
            self._broken = True
        elif self._left_in_group:
            self._content.append(byte)
            self._left_in_group -= 1
        else:
            if self._zero_owed:
                self._content.append(0)
            self._left_in_group = byte - 1
            self._zero_owed = byte != 0xFF
        return None

    def _end(self) -> bytes | None:
        """Judge what came since the last delimiter; nothing at all is no frame, and no fault."""
        content, began = bytes(self._content), self._began
        whole = not self._broken and not self._left_in_group
        self._restart()
        if not began:
            return None
        if whole and _MIN_CONTENT <= len(content) <= _MAX_CONTENT:
            crc = int.from_bytes(content[-_CRC_BYTES:], "little")
            if crc == crc16(content[:-_CRC_BYTES]):
                return content
        self.bad_frames = min(self.bad_frames + 1, _COUNT_MAX)
        return None
