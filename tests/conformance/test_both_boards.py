"""The emulated board and the image side by side: the same replies, words and drives."""

from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hil_sim.line import BYTE_S
from usmbench.instruments.protocol import _generated as wire
from usmbench.instruments.protocol._generated import RequestType
from usmbench.instruments.protocol.frames import encode_frame

if TYPE_CHECKING:
    from tests.conformance.conftest import BenchHost

frames = st.builds(
    encode_frame,
    st.integers(0, 3),
    st.one_of(st.sampled_from(list(RequestType)), st.integers(0, 255)),
    st.binary(max_size=wire.MAX_PAYLOAD),
)
sound = st.one_of(
    st.builds(
        lambda sequence, frequency, phase: encode_frame(
            sequence,
            RequestType.SET_DRIVE,
            frequency.to_bytes(4, "little") + phase.to_bytes(2, "little", signed=True),
        ),
        st.integers(0, 3),
        st.integers(wire.FREQUENCY_WORD_MIN - 1, wire.FREQUENCY_WORD_MAX + 1),
        st.integers(-2050, 2050),
    ),
    st.builds(
        lambda sequence, on: encode_frame(sequence, RequestType.OUTPUTS, bytes([on])),
        st.integers(0, 3),
        st.integers(0, 2),
    ),
    st.builds(
        lambda sequence, kind: encode_frame(sequence, kind, b""),
        st.integers(0, 3),
        st.sampled_from([RequestType.IDENTIFY, RequestType.STATUS, RequestType.HEARTBEAT]),
    ),
)
noise = st.binary(min_size=1, max_size=60).map(lambda data: data + b"\0")


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(chunks=st.lists(st.one_of(sound, sound, frames, noise), max_size=12))
def test_any_bytes_do_the_same_to_both(
    both_boards: "tuple[BenchHost, BenchHost]", chunks: list[bytes]
) -> None:
    seen = []
    for host in both_boards:
        replies = [host.exchange(chunk) for chunk in chunks]
        drives = [drive for _, drive in host.line.board.drive_changes]
        host.line.board.drive_changes.clear()
        seen.append((replies, host.new_words(), drives))
    assert seen[0] == seen[1]


def test_every_word_asked_for_is_the_one_that_is_sent(
    both_boards: "tuple[BenchHost, BenchHost]",
) -> None:
    """Every bit of the frequency and every phase in coarse steps, on both boards."""
    for host in both_boards:
        host.start()
    # A stride prime to the range's length reaches every pattern of the low bits.
    words = range(wire.FREQUENCY_WORD_MIN, wire.FREQUENCY_WORD_MAX + 1, 149)
    for index, word in enumerate(words):
        phase = (index * 61) % 4097 - 2048
        for host in both_boards:
            assert host.ask(RequestType.SET_DRIVE, word, phase).acknowledged
        emulated, image = (host.new_words() for host in both_boards)
        assert emulated == image
        assert (
            both_boards[1].line.board.drive_changes[-1][1]
            == (both_boards[0].line.board.drive_changes[-1][1])
        )


def test_a_setting_takes_force_at_the_same_time(
    both_boards: "tuple[BenchHost, BenchHost]",
) -> None:
    """To a few turns of the firmware's main loop and the interrupts between them."""
    delays_s = []
    for host in both_boards:
        host.start()
        host.line.board.drive_changes.clear()
        ends_s = []
        for frame in (
            host.frame(RequestType.SET_DRIVE, 441_000, 100),
            host.frame(RequestType.SET_PHASE, -2000),
            host.frame(RequestType.OUTPUTS, 0),
            host.frame(RequestType.OUTPUTS, 1),
        ):
            ends_s.append(host.line.now_s + len(frame) * BYTE_S)
            host.ask_raw(frame)
        changes = host.line.board.drive_changes
        delays_s.append([time_s - e for (time_s, _), e in zip(changes, ends_s, strict=True)])
    assert delays_s[0] == pytest.approx(delays_s[1], abs=30e-6)
    assert min(delays_s[0]) > 30e-6
