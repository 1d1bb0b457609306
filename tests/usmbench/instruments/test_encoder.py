"""The encoder arithmetic against shafts whose exact angle is known."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.errors import DaqError
from usmbench.instruments.encoder import EncoderGeometry, EncoderState, WindowMotion, decode
from usmbench.instruments.samples import SampleBlock

GEOMETRY = EncoderGeometry(counts_per_rev=2000, counter_bits=32, sign=1, sample_rate_hz=100_000.0)
COUNT_RAD = 2.0 * pi / 2000


def windows(
    position: NDArray[np.int64], lengths: list[int], geometry: EncoderGeometry = GEOMETRY
) -> list[WindowMotion]:
    """Decode a stream of unwrapped positions, cut into blocks of these lengths."""
    counts = position & ((1 << geometry.counter_bits) - 1)
    state, motions, start = EncoderState(), [], 0
    for length in lengths:
        state, motion = decode(state, SampleBlock(start, counts[start : start + length]), geometry)
        motions.append(motion)
        start += length
    return motions


def windows_of(angle_rad: NDArray[np.float64]) -> list[WindowMotion]:
    """Decode an exact angle at every sample in blocks of 1000."""
    position = np.floor(angle_rad / COUNT_RAD).astype(np.int64)
    return windows(position, [1000] * (len(position) // 1000))


def edge_timed(motions: list[WindowMotion]) -> NDArray[np.float64]:
    return np.array([m.edge_timed_rad_s for m in motions])


def exact(angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Average speed of each block from the second on, from its ends."""
    ends = angle_rad[999::1000]
    return np.diff(ends) / 0.01


streams = st.lists(
    st.tuples(st.sampled_from([-3, -1, -1, 0, 0, 1, 1, 2]), st.integers(1, 40)),
    min_size=1,
    max_size=30,
).map(lambda runs: np.cumsum(np.repeat([s for s, _ in runs], [n for _, n in runs])))
cuts = st.lists(st.integers(1, 60), min_size=1, max_size=8)


def lengths_from(n_samples: int, pattern: list[int]) -> list[int]:
    lengths: list[int] = []
    while (left := n_samples - sum(lengths)) > 0:
        lengths.append(min(pattern[len(lengths) % len(pattern)], left))
    return lengths


@given(streams, cuts)
@settings(deadline=None)
def test_averages_sum_to_the_angle_of_whole_counts(
    position: NDArray[np.int64], pattern: list[int]
) -> None:
    motions = windows(position, lengths_from(len(position), pattern))
    total = int(position[-1] - position[0])
    assert sum(m.counts for m in motions) == total
    assert motions[-1].angle_rad == pytest.approx(total * COUNT_RAD, abs=1e-12)
    summed = sum(m.average_rad_s * m.window_s for m in motions)
    assert summed == pytest.approx(total * COUNT_RAD, abs=1e-9)


@given(streams, cuts)
@settings(deadline=None)
def test_edge_timed_never_drifts_from_the_counts(
    position: NDArray[np.int64], pattern: list[int]
) -> None:
    motions = windows(position, lengths_from(len(position), pattern))
    summed = np.cumsum([m.edge_timed_rad_s * m.window_s for m in motions])
    angle = np.array([m.angle_rad for m in motions])
    # Both ends are known to within the count they lie in.
    assert np.max(np.abs(summed - angle)) <= COUNT_RAD * (1 + 1e-6)


@given(streams, cuts, cuts)
@settings(deadline=None)
def test_the_angle_does_not_depend_on_where_the_stream_is_cut(
    position: NDArray[np.int64], one: list[int], other: list[int]
) -> None:
    a = windows(position, lengths_from(len(position), one))
    b = windows(position, lengths_from(len(position), other))
    assert a[-1].angle_rad == b[-1].angle_rad


@given(streams, cuts, st.sampled_from([8, 24, 32]), st.integers(-(2**33), 2**33))
@settings(deadline=None)
def test_a_wrapping_counter_gives_the_same_motion(
    position: NDArray[np.int64], pattern: list[int], bits: int, offset: int
) -> None:
    lengths = lengths_from(len(position), pattern)
    plain = windows(position, lengths)
    wrapped = windows(position + offset, lengths, EncoderGeometry(2000, bits, 1, 100_000.0))
    assert wrapped == plain


@given(streams, cuts)
@settings(deadline=None)
def test_the_sign_turns_every_quantity(position: NDArray[np.int64], pattern: list[int]) -> None:
    lengths = lengths_from(len(position), pattern)
    plain = windows(position, lengths)
    turned = windows(position, lengths, EncoderGeometry(2000, 32, -1, 100_000.0))
    for p, t in zip(plain, turned, strict=True):
        assert (t.angle_rad, t.average_rad_s, t.edge_timed_rad_s, t.counts) == (
            -p.angle_rad,
            -p.average_rad_s,
            -p.edge_timed_rad_s,
            -p.counts,
        )


@given(streams, cuts)
@settings(deadline=None)
def test_a_shaft_run_the_other_way_shows_the_opposite_speed(
    position: NDArray[np.int64], pattern: list[int]
) -> None:
    lengths = lengths_from(len(position), pattern)
    forward = edge_timed(windows(position, lengths))
    # A count p says that the shaft is at p … p + 1; turned round that is count -p - 1.
    assert edge_timed(windows(-position - 1, lengths)) == pytest.approx(-forward, abs=1e-6)


@pytest.mark.parametrize("speed_rad_s", [1.0, 1.37, 2.9, 5.0, 10.25, -1.01, -7.7])
def test_constant_speed_is_known_to_half_a_permille(speed_rad_s: float) -> None:
    start = np.random.default_rng().uniform(0, COUNT_RAD)
    motions = windows_of(start + np.arange(200_000) / 100_000 * speed_rad_s)
    error = edge_timed(motions)[1:] / speed_rad_s - 1.0
    assert np.sqrt(np.mean(error**2)) <= 5e-4
    average = np.array([m.average_rad_s for m in motions])[1:] / speed_rad_s - 1.0
    assert np.sqrt(np.mean(average**2)) > 10 * np.sqrt(np.mean(error**2))


def test_the_first_window_is_as_good_when_the_shaft_turns_already() -> None:
    motions = windows_of(0.001 + np.arange(1000) / 100_000 * 6.0)
    assert motions[0].window_s == pytest.approx(999e-5)
    assert motions[0].edge_timed_rad_s == pytest.approx(6.0, rel=2e-3)


@pytest.mark.parametrize(("low", "high"), [(2.0, 10.0), (10.0, 1.0), (-8.0, -3.0)])
def test_a_changing_speed_is_averaged_over_its_own_window(low: float, high: float) -> None:
    t_s = np.arange(100_000) / 100_000
    lag_s = 3.5e-3
    square = np.where((t_s % 0.1) < 0.05, low, high)
    since = t_s % 0.05
    speed = square + (low + high - 2 * square) * np.exp(-since / lag_s)
    angle = np.cumsum(speed) / 100_000
    error = edge_timed(windows_of(angle))[1:] - exact(angle)
    assert np.sqrt(np.mean(error**2)) <= 0.01 * max(abs(low), abs(high))


def test_standstill_is_exactly_zero_and_comes_to_rest_within_one_count() -> None:
    angle = np.concatenate((np.arange(5000) * 5e-5, np.full(20_000, 4999 * 5e-5)))
    motions = windows_of(angle)
    after = edge_timed(motions)[5:]
    # One count in the time since the last edge bounds the speed.
    assert np.all(np.abs(after) <= COUNT_RAD / (0.01 * np.arange(1, len(after) + 1)) * 1.01)
    assert np.all(after[2:] == 0.0)


def test_a_reversal_counts_no_edge_twice() -> None:
    t_s = np.arange(60_000) / 100_000
    angle = 0.3 * np.sin(2 * pi * 5 * t_s)
    motions = windows_of(angle)
    assert np.max(np.abs(edge_timed(motions)[1:] - exact(angle))) <= COUNT_RAD / 0.01
    assert motions[-1].counts == np.floor(angle[-1] / COUNT_RAD) - np.floor(
        angle[-1001] / COUNT_RAD
    )


def test_dither_on_one_edge_is_no_motion() -> None:
    position = np.random.default_rng().integers(7, 9, 20_000)
    motions = windows(position, [1000] * 20)
    assert np.all(edge_timed(motions)[1:] == 0.0)


def test_a_dead_channel_toggles_without_speed() -> None:
    position = (np.arange(20_000) // 31) % 2
    assert np.all(edge_timed(windows(position, [1000] * 20))[1:] == 0.0)


def test_false_counts_leave_the_angle_where_it_was() -> None:
    position = np.arange(10_000) // 100
    position[5555] += 4096
    motions = windows(position, [1000] * 10)
    assert motions[-1].angle_rad == pytest.approx(99 * COUNT_RAD)
    assert edge_timed(motions)[-1] == pytest.approx(COUNT_RAD * 1000, rel=1e-2)


def test_counting_one_edge_a_line() -> None:
    geometry = EncoderGeometry(500, 24, 1, 100_000.0)
    position = np.floor(np.arange(100_000) / 100_000 * 5.0 * 500 / (2 * pi)).astype(np.int64)
    motions = windows(position, [1000] * 100, geometry)
    error = edge_timed(motions)[2:] / 5.0 - 1.0
    assert np.sqrt(np.mean(error**2)) <= 1e-3


def test_a_missing_block_is_an_error_and_not_a_false_speed() -> None:
    state, _ = decode(EncoderState(), SampleBlock(0, np.zeros(1000, np.int64)), GEOMETRY)
    with pytest.raises(DaqError, match=r"samples 1000 to 2000.*and begin again$"):
        decode(state, SampleBlock(2000, np.zeros(1000, np.int64)), GEOMETRY)
