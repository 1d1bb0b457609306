"""Answers to reads, as bytes: numbers that a numpy array holds need not become Python's first."""

from collections.abc import Callable
from typing import Any, Final

import numpy as np
from nidaqmx._stubs import nidaqmx_pb2 as pb

from hil_sim.ni_server.channels import Values

_READ_ARRAY_TAG: Final = bytes([2 << 3 | 2])  # field 2, length-delimited: read_array, packed
_CONTINUES: Final = 0x80


def read_answer(response: Callable[..., Any], values: Values) -> Any:
    """Return the answer to a read, with packed doubles where `values` are such.

    A packed list of doubles is, on the wire, their little-endian bytes:
    https://protobuf.dev/programming-guides/encoding/#packed

    Parameters
    ----------
    response
        Class of the answer.
    values
        What was read, shape (N,).
    """
    if response is pb.ReadCounterU32ExResponse:
        return response(read_array=values.tolist(), samps_per_chan_read=len(values))
    packed = np.ascontiguousarray(values, "<f8").tobytes()
    answer = response(samps_per_chan_read=len(values))
    answer.MergeFromString(_READ_ARRAY_TAG + varint(len(packed)) + packed)
    return answer


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
