"""The frame codec: round trip, any bytes in any split, corrupted frames."""

import itertools
from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usmbench.instruments.protocol import _generated
from usmbench.instruments.protocol.frames import (
    MAX_ENCODED,
    Frame,
    FrameReader,
    crc16,
    decode_frame,
    encode_frame,
    encoded_size,
)

byte = st.integers(0, 255)
payloads = st.binary(max_size=_generated.MAX_PAYLOAD) | st.lists(
    st.sampled_from([0, 1, 255]), max_size=_generated.MAX_PAYLOAD
).map(bytes)
frames = st.builds(Frame, byte, byte, payloads)
# Noise of all kinds: any bytes, whole frames, overlong stretches.
streams = st.lists(
    st.binary(max_size=90)
    | frames.map(lambda frame: encode_frame(*frame))
    | st.integers(MAX_ENCODED - 2, MAX_ENCODED + 40).map(lambda n: b"\x01" * n),
    max_size=8,
).map(b"".join)


def cut(stream: bytes, places: Sequence[int]) -> list[bytes]:
    edges = sorted({0, len(stream), *(place % (len(stream) + 1) for place in places)})
    return [stream[a:b] for a, b in itertools.pairwise(edges)]


def test_crc_has_its_published_check_value() -> None:
    assert crc16(b"123456789") == _generated.CRC_CHECK


@settings(deadline=None)
@given(frames)
def test_round_trip(frame: Frame) -> None:
    encoded = encode_frame(*frame)
    assert encoded.count(0) == 1
    assert len(encoded) == encoded_size(len(frame.payload))
    assert FrameReader().feed(encoded) == [frame]


@settings(deadline=None, max_examples=300)
@given(streams, st.lists(st.integers(0, 2000), max_size=20))
def test_no_stream_raises_and_no_split_matters(stream: bytes, places: Sequence[int]) -> None:
    whole, pieces = FrameReader(), FrameReader()
    expected = whole.feed(stream)
    got = list(itertools.chain.from_iterable(pieces.feed(piece) for piece in cut(stream, places)))
    assert got == expected
    assert pieces.n_bad == whole.n_bad


@settings(deadline=None, max_examples=300)
@given(st.binary(max_size=300), frames)
def test_a_frame_after_a_delimiter_is_found_whatever_came_before(
    noise: bytes, frame: Frame
) -> None:
    assert FrameReader().feed(noise + b"\0" + encode_frame(*frame))[-1] == frame


@settings(deadline=None, max_examples=300)
@given(frames, st.data())
def test_a_burst_inside_the_payload_is_always_refused(frame: Frame, data: st.DataObject) -> None:
    """Two neighbouring bytes hold no more than 16 bits: CRC-16 sees any change of them."""
    body = bytes((frame.sequence, frame.type)) + frame.payload
    place = data.draw(st.integers(0, len(body) - 2))
    change = data.draw(st.integers(1, 0xFFFF)).to_bytes(2, "big")
    spoiled = bytearray(body)
    spoiled[place] ^= change[0]
    spoiled[place + 1] ^= change[1]
    assert crc16(bytes(spoiled)) != crc16(body)


def test_overlong_stretches_are_one_bad_frame_and_take_no_memory() -> None:
    reader = FrameReader()
    for _ in range(1000):
        assert reader.feed(b"\x05" * 1000) == []
    assert len(reader._rest) <= MAX_ENCODED + 1
    assert reader.n_bad == 0
    assert reader.feed(b"\0") == []
    assert reader.n_bad == 1


def test_empty_stretches_are_not_bad_frames() -> None:
    reader = FrameReader()
    assert reader.feed(b"\0\0\0") == []
    assert reader.n_bad == 0


@pytest.mark.parametrize("size", [0, 1, 3, 4])
def test_a_stretch_too_short_for_a_frame_is_none(size: int) -> None:
    assert decode_frame(b"\x01" * size) is None


def test_a_payload_that_does_not_fit_is_a_mistake_of_ours() -> None:
    with pytest.raises(ValueError, match="33 bytes"):
        encode_frame(0, 1, bytes(33))


def test_clear_forgets_only_the_unfinished_frame() -> None:
    frame = Frame(1, 0x86, b"\x02")
    reader = FrameReader()
    reader.feed(encode_frame(9, 0x86, b"\x02")[:4])
    reader.clear()
    assert reader.feed(encode_frame(*frame)) == [frame]


@given(st.binary(max_size=60))
def test_decoding_takes_any_bytes(stretch: bytes) -> None:
    frame = decode_frame(stretch)
    assert frame is None or encode_frame(*frame) == stretch + b"\0"
