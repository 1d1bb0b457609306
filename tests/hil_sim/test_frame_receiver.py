"""The board's framing against the host's, which was written apart from it."""

from hypothesis import given, settings
from hypothesis import strategies as st

from hil_sim.frame_receiver import FrameReceiver, build_frame, crc16
from usmbench.instruments.protocol._generated import CRC_CHECK, MAX_PAYLOAD
from usmbench.instruments.protocol.frames import FrameReader, encode_frame

PAYLOADS = st.binary(max_size=MAX_PAYLOAD)
BYTES = st.integers(0, 255)


def received(receiver: FrameReceiver, stream: bytes) -> list[bytes]:
    contents = [receiver.push(byte) for byte in stream]
    return [content for content in contents if content is not None]


def test_crc_has_its_check_value() -> None:
    assert crc16(b"123456789") == CRC_CHECK


@settings(deadline=None)
@given(BYTES, BYTES, PAYLOADS)
def test_both_codecs_write_the_same_bytes(sequence: int, kind: int, payload: bytes) -> None:
    frame = encode_frame(sequence, kind, payload)
    assert build_frame(bytes((sequence, kind)) + payload) == frame
    assert received(FrameReceiver(), frame) == [
        bytes((sequence, kind))
        + payload
        + crc16(bytes((sequence, kind)) + payload).to_bytes(2, "little")
    ]


@settings(deadline=None, max_examples=300)
@given(st.lists(st.one_of(st.binary(max_size=60), PAYLOADS.map(lambda p: encode_frame(1, 2, p)))))
def test_any_stream_gives_what_the_host_would_read(pieces: list[bytes]) -> None:
    stream = b"".join(pieces)
    receiver, reader = FrameReceiver(), FrameReader()
    contents = received(receiver, stream)
    frames = reader.feed(stream)
    assert [(c[0], c[1], c[2:-2]) for c in contents] == [tuple(frame) for frame in frames]
    assert receiver.bad_frames == reader.n_bad


def test_bad_frames_stop_at_the_end_of_their_count() -> None:
    receiver = FrameReceiver()
    received(receiver, b"\x01\x00" * 65_600)
    assert receiver.bad_frames == 65_535
