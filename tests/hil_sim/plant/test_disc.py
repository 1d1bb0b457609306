"""The disc against an X4 decoder that looks at the channels' levels one sample at a time."""

import math

import numpy as np
import pytest

from hil_sim.plant.disc import Channel, Disc
from hil_sim.plant.parameters import DiscParameters
from hil_sim.plant.rotor import Piece, RotorState

FORWARD = {(0, 0): 0, (1, 0): 1, (1, 1): 2, (0, 1): 3}
RAD_PER_COUNT = 2.0 * math.pi / 2000
# Irrational, so that no sample falls on an edge.
OFFSET = math.sqrt(0.07)
PARAMETERS = DiscParameters(start_offset_counts=OFFSET, index_count=137)


def turning(counts_per_s: float, start_s: float = 0.0, shaft: float = 0.0) -> Piece:
    """Path of a shaft at a steady speed from a place given in counts."""
    turns = math.floor(shaft / 2000)
    angle_rad = (shaft - 2000 * turns) * RAD_PER_COUNT
    return (start_s, turns, angle_rad, counts_per_s * RAD_PER_COUNT, 0.0, 0.0)


def state(shaft: float) -> RotorState:
    turns = math.floor(shaft / 2000)
    return RotorState(0.0, turns, (shaft - 2000 * turns) * RAD_PER_COUNT)


def decode(true: np.ndarray, stuck: dict[Channel, int]) -> np.ndarray:
    """X4 count of a decoder that sees one channel stuck at a level."""
    a = np.isin(true % 4, (1, 2)).astype(int)
    b = np.isin(true % 4, (2, 3)).astype(int)
    a = np.full_like(a, stuck["a"]) if "a" in stuck else a
    b = np.full_like(b, stuck["b"]) if "b" in stuck else b
    codes = np.array([FORWARD[levels] for levels in zip(a.tolist(), b.tolist(), strict=True)])
    steps = (np.diff(codes) + 1) % 4 - 1
    return np.concatenate([[0], np.cumsum(steps)])


@pytest.mark.parametrize("counts_per_s", [3000.0, -3000.0, 123.4, 25_000.0])
def test_count_is_the_floor_of_the_exact_angle(counts_per_s: float) -> None:
    times_s = np.arange(5000) / 1e5
    position, _ = Disc(PARAMETERS).read(times_s, [turning(counts_per_s)])
    np.testing.assert_array_equal(position, np.floor(counts_per_s * times_s + OFFSET))


def test_cubic_pieces_are_followed_each_from_its_start() -> None:
    pieces: list[Piece] = [
        (0.0, 0, 0.0, 2.0, 30.0, -40.0),
        (0.01, 0, 0.02296, 2.588, 0.0, 0.0),
        (0.02, 0, 0.04884, 0.0, 0.0, 0.0),
    ]
    times_s = np.arange(300) / 1e4
    t = times_s
    angle_rad = np.where(
        t < 0.01, 2.0 * t + 30.0 * t**2 - 40.0 * t**3, 0.02296 + 2.588 * (t - 0.01)
    )
    angle_rad[t >= 0.02] = 0.04884
    position, _ = Disc(PARAMETERS).read(times_s, pieces)
    np.testing.assert_array_equal(position, np.floor(angle_rad / RAD_PER_COUNT + OFFSET))


def test_precision_does_not_fade_with_the_revolutions() -> None:
    times_s = np.arange(1000) / 1e5
    start_s, _, angle_rad, speed, second, third = turning(3000.0)
    near, far = (
        Disc(PARAMETERS).read(times_s, [(start_s, turns, angle_rad, speed, second, third)])[0]
        for turns in (0, 140_000)
    )
    np.testing.assert_array_equal(far - near, 140_000 * 2000)


def test_index_pulses_are_counted_in_either_direction() -> None:
    disc = Disc(PARAMETERS)
    times_s = np.arange(1000) / 1000.0
    _, up = disc.read(times_s, [turning(5000.0)])
    assert up[0] == 0
    # Crossings at counts 137, 2137, 4137 on the way up to 4995 …
    assert up[-1] == 3
    assert np.flatnonzero(np.diff(up))[0] == pytest.approx(137 / 5, abs=1)
    _, down = disc.read(1.0 + times_s, [turning(-5000.0, 1.0, 5000.0)])
    # … and the same three on the way back.
    assert down[-1] == 6


def test_index_at_the_start_position_is_not_crossed_by_standing_there() -> None:
    disc = Disc(DiscParameters(index_count=0))
    times_s = np.arange(10) / 1000.0
    assert disc.read(times_s, [turning(0.0)])[1].tolist() == [0] * 10


@pytest.mark.parametrize("counts_per_s", [3000.0, -3000.0])
@pytest.mark.parametrize("channel", ["a", "b"])
@pytest.mark.parametrize("start", range(4))
def test_dead_channel_shows_what_a_decoder_would(
    counts_per_s: float, channel: Channel, start: int
) -> None:
    """The channel dies at each of the four states, and is mended at some later one."""
    times_s = np.arange(2000) / 1e5
    true = np.floor(start + counts_per_s * times_s + OFFSET).astype(np.int64)
    disc = Disc(PARAMETERS)
    first, _ = disc.read(np.array([0.0]), [turning(0.0, shaft=start)])
    disc.set_dead_channel(channel, state(start))
    level = int(true[0] % 4 in ((1, 2) if channel == "a" else (2, 3)))
    shown, _ = disc.read(times_s, [turning(counts_per_s, shaft=start)])
    np.testing.assert_array_equal(shown - first, decode(true, {channel: level}))
    assert shown.max() - shown.min() == 1

    mended_at = start + counts_per_s * times_s[-1]
    disc.set_dead_channel(None, state(mended_at))
    after, _ = disc.read(1.0 + times_s, [turning(counts_per_s, 1.0, mended_at)])
    assert abs(int(after[0] - shown[-1])) <= 1
    assert (int(after[0]) - int(first[0]) - int(true[-1]) + int(true[0])) % 4 == 0
    np.testing.assert_array_equal(
        after - after[0], np.floor(mended_at + counts_per_s * times_s + OFFSET) - true[-1]
    )


def test_slipped_disc_stands_and_goes_on_from_there() -> None:
    disc = Disc(PARAMETERS)
    times_s = np.arange(1000) / 1e5
    disc.read(times_s, [turning(3000.0)])
    disc.set_coupling(False, state(30.0))
    still, pulses = disc.read(times_s, [turning(3000.0, shaft=30.0)])
    assert set(still.tolist()) == {30}
    assert set(pulses.tolist()) == {0}
    disc.set_coupling(True, state(7030.0))
    again, _ = disc.read(times_s, [turning(3000.0, shaft=7030.0)])
    np.testing.assert_array_equal(again, np.floor(30.0 + 3000.0 * times_s + OFFSET))
