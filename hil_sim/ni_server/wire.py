"""Answers to reads, as bytes: numbers that a numpy array holds need not become Python's first."""

from collections.abc import Callable
from typing import Any, Final

import numpy as np
from nidaqmx._stubs import nidaqmx_pb2 as pb

from hil_sim.ni_server.channels import Values

_READ_ARRAY_TAG: Final = bytes([2 << 3 | 2])  # field 2, length-delimited: read_array, packed
_CONTINUES: Final = 0x80


def read_answer(response: Callable[..., Any], values: Values) -> Any:
    """Return the answer to a read, its values packed without a detour.

    A packed list of doubles is, on the wire, their little-endian bytes, one of unsigned integers
    their variable-length encodings: https://protobuf.dev/programming-guides/encoding/#packed

    Parameters
    ----------
    response
        Class of the answer.
    values
        What was read, shape (N,).
    """
    if response is pb.ReadCounterU32ExResponse:
        packed = packed_varints(values)
    else:
        packed = np.ascontiguousarray(values, "<f8").tobytes()
    answer = response(samps_per_chan_read=len(values))
    answer.MergeFromString(_READ_ARRAY_TAG + varint(len(packed)) + packed)
    return answer


def packed_varints(values: Values) -> bytes:
    """Return counts in protobuf's variable-length encoding, one behind the other.

    Parameters
    ----------
    values
        The counts, not negative, shape (N,), N ≥ 1.
    """
    # A counter stays at a value for many samples: each is encoded once.
    begins = np.concatenate(([0], np.flatnonzero(values[1:] != values[:-1]) + 1))
    lengths = np.diff(begins, append=len(values))
    runs = zip(values[begins].tolist(), lengths.tolist(), strict=True)
    return b"".join(varint(value) * length for value, length in runs)


def varint(number: int) -> bytes:
    """Return a number in protobuf's variable-length encoding.

    Parameters
    ----------
    number
        The number, not negative.
    """
    encoded = bytearray()
    while number >= _CONTINUES:
        encoded.append(number & (_CONTINUES - 1) | _CONTINUES)
        number >>= 7
    return bytes([*encoded, number])
