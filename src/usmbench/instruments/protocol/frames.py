"""Frames: COBS between delimiters, with a sequence number, a type and a CRC-16.

COBS (S. Cheshire and M. Baker, doi:10.1109/90.769765) leaves no zero inside a frame, so a reader
that has lost its place finds it again at the next zero. A frame is shorter than 254 bytes, where
COBS costs exactly one byte and has exactly one encoding of everything.
"""

from binascii import crc_hqx
from typing import Final, NamedTuple

from usmbench.instruments.protocol._generated import CRC_INITIAL, DELIMITER, MAX_PAYLOAD

DELIMITER_BYTE: Final = bytes((DELIMITER,))

_HEADER_SIZE = 2
_CRC_SIZE = 2
_BYTES = tuple(bytes((value,)) for value in range(256))

MIN_DECODED: Final = _HEADER_SIZE + _CRC_SIZE
MAX_DECODED: Final = _HEADER_SIZE + MAX_PAYLOAD + _CRC_SIZE
MAX_ENCODED: Final = MAX_DECODED + 1


class Frame(NamedTuple):
    """One frame, as it was before encoding.

    Parameters
    ----------
    sequence
        Sequence number, 0…255.
    type
        Type byte: a request type, with the reply bits in a reply.
    payload
        At most `MAX_PAYLOAD` bytes.
    """

    sequence: int
    type: int
    payload: bytes


def crc16(data: bytes) -> int:
    """Return the CRC-16/IBM-3740 of some bytes.

    Parameters
    ----------
    data
        Bytes, most significant bit first.

    Returns
    -------
    int
        Remainder modulo x¹⁶ + x¹² + x⁵ + 1, from 0xFFFF, neither reflected nor inverted.
    """
    return crc_hqx(data, CRC_INITIAL)


def encode_frame(sequence: int, frame_type: int, payload: bytes) -> bytes:
    """Encode one frame for the line.

    Parameters
    ----------
    sequence
        Sequence number, 0…255.
    frame_type
        Type byte.
    payload
        Payload.

    Returns
    -------
    bytes
        The encoded frame and its delimiter.

    Raises
    ------
    ValueError
        The payload is longer than `MAX_PAYLOAD`, or a number does not fit a byte.
    """
    if len(payload) > MAX_PAYLOAD:
        raise ValueError(f"payload of {len(payload)} bytes; a frame takes {MAX_PAYLOAD}")
    body = bytes((sequence, frame_type)) + payload
    body += crc16(body).to_bytes(_CRC_SIZE, "little")
    blocks = [_BYTES[len(block) + 1] + block for block in body.split(DELIMITER_BYTE)]
    return b"".join(blocks) + DELIMITER_BYTE


def encoded_size(payload_size: int) -> int:
    """Return how many bytes a frame takes on the line, delimiter included.

    Parameters
    ----------
    payload_size
        Size of its payload in bytes.
    """
    return MIN_DECODED + payload_size + 2


def decode_frame(encoded: bytes) -> Frame | None:
    """Decode what stood between two delimiters.

    Parameters
    ----------
    encoded
        Any bytes.

    Returns
    -------
    Frame or None
        The frame, or None where this is not a frame with the right CRC.
    """
    size = len(encoded)
    if not MIN_DECODED < size <= MAX_ENCODED or DELIMITER in encoded:
        return None
    blocks = []
    start = 0
    while start < size:
        end = start + encoded[start]
        blocks.append(encoded[start + 1 : end])
        start = end
    if start != size:
        return None
    body = DELIMITER_BYTE.join(blocks)
    if crc_hqx(body[:-_CRC_SIZE], CRC_INITIAL) != body[-2] | body[-1] << 8:
        return None
    return Frame(body[0], body[1], body[_HEADER_SIZE:-_CRC_SIZE])


class FrameReader:
    """Finds the frames in a stream of bytes, however it is cut into pieces.

    It holds at most `MAX_ENCODED` + 1 bytes between two calls.
    """

    def __init__(self) -> None:
        self._rest = b""
        self._n_bad = 0

    @property
    def n_bad(self) -> int:
        """Number of non-empty stretches between delimiters that were not frames."""
        return self._n_bad

    def feed(self, data: bytes) -> list[Frame]:
        """Take the next bytes of the stream.

        Parameters
        ----------
        data
            Any bytes, of any length.

        Returns
        -------
        list of Frame
            Frames that these bytes completed, in order.
        """
        *stretches, rest = (self._rest + data).split(DELIMITER_BYTE)
        # One byte more than a frame may have is enough to know later that it is none.
        self._rest = rest[: MAX_ENCODED + 1]
        frames = []
        for stretch in stretches:
            frame = decode_frame(stretch)
            if frame is not None:
                frames.append(frame)
            elif stretch:
                self._n_bad += 1
        return frames

    def clear(self) -> None:
        """Forget the beginning of a frame that is not complete."""
        self._rest = b""
