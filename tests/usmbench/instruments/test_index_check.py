"""The index pulse against lost counts and wrong counts per revolution."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.errors import DaqError
from usmbench.instruments.encoder import EncoderGeometry, EncoderState, decode
from usmbench.instruments.index_check import measure_counts_per_rev
from usmbench.instruments.samples import SampleBlock

RATE_HZ = 100_000.0


def blocks_of(
    angle_rad: NDArray[np.float64], counts_per_rev: int = 2000, lost: NDArray[np.int64] | int = 0
) -> list[SampleBlock]:
    """Sample a wheel with an index mark one count wide, 700 counts from zero."""
    position = np.floor(angle_rad * counts_per_rev / (2 * pi)).astype(np.int64)
    on_mark = (position % counts_per_rev == 700 % counts_per_rev).astype(np.int64)
    pulses = np.cumsum(np.diff(on_mark, prepend=on_mark[0]) > 0)
    counts = (position - lost) & 0xFFFFFF
    return [
        SampleBlock(k, counts[k : k + 1000], pulses[k : k + 1000])
        for k in range(0, len(counts) - 999, 1000)
    ]


def errors(blocks: list[SampleBlock], counts_per_rev: int = 2000, sign: int = 1) -> list[int]:
    geometry = EncoderGeometry(counts_per_rev, 24, sign, RATE_HZ)
    state, found = EncoderState(), []
    for block in blocks:
        state, motion = decode(state, block, geometry)
        if motion.index_error_counts is not None:
            found.append(motion.index_error_counts)
    return found


def lost_at_half(angle_rad: NDArray[np.float64], lost: int) -> NDArray[np.int64]:
    """Return how many counts are missing when the counter stands still for `lost` of them."""
    position = np.floor(angle_rad * 2000 / (2 * pi)).astype(np.int64)
    missing: NDArray[np.int64] = np.clip(position - position[len(position) // 2], 0, lost)
    return missing


def turning(speed_rad_s: float, duration_s: float = 4.0) -> NDArray[np.float64]:
    return np.arange(round(duration_s * RATE_HZ)) / RATE_HZ * speed_rad_s


@pytest.mark.parametrize("speed_rad_s", [9.0, -9.0])
def test_an_undisturbed_wheel_shows_no_error(speed_rad_s: float) -> None:
    found = errors(blocks_of(turning(speed_rad_s)))
    assert len(found) >= 4
    assert set(found) == {0}


@given(st.floats(0.5, 20.0), st.floats(2.0, 15.0), st.floats(0.3, 3.0), st.floats(-9.0, 9.0))
@settings(deadline=None, max_examples=15)
def test_reversals_over_the_index_are_no_error(
    drift: float, amplitude_rad: float, rate_hz: float, start_rad: float
) -> None:
    t_s = np.arange(200_000) / RATE_HZ
    angle = start_rad + drift * t_s + amplitude_rad * np.sin(2 * pi * rate_hz * t_s)
    assert set(errors(blocks_of(angle))) <= {0}


def test_turning_round_upon_the_mark_is_no_error() -> None:
    turns_at = np.array([1500, 100, 700 + 3 * 2000, 100 - 2000])
    counts = [np.arange(a, b, np.sign(b - a)) for a, b in pairwise(turns_at)]
    # Ten samples a count, the last count before the way back on the mark itself.
    angle = np.repeat(np.concatenate((*counts, [700 + 3 * 2000])) + 0.5, 10) * 2 * pi / 2000
    at_mark = sum(map(len, counts[:2])) * 10
    angle = np.insert(angle[:-10], at_mark, angle[-10:])
    assert set(errors(blocks_of(angle))) == {0}


def test_dither_on_the_index_is_no_error() -> None:
    edge = 700 * 2 * pi / 2000
    dither = np.random.default_rng().normal(edge, 2e-3, 100_000)
    angle = np.concatenate(
        (np.linspace(edge - 3.0, edge, 50_000), dither, turning(9.0, 2.0) + edge)
    )
    assert set(errors(blocks_of(angle))) <= {0}


@pytest.mark.parametrize("lost", [2, 5, 300, 900])
@pytest.mark.parametrize("sign", [1, -1])
def test_counts_lost_at_once_are_reported_once(lost: int, sign: int) -> None:
    angle = turning(9.0)
    found = errors(blocks_of(angle, lost=lost_at_half(angle, lost)), sign=sign)
    assert [e for e in found if e] == [pytest.approx(-lost * sign, abs=1)]


def test_counts_lost_one_a_revolution_add_up_until_they_show() -> None:
    angle = turning(9.0, 8.0)
    missing = (angle / (2 * pi)).astype(np.int64)
    found = errors(blocks_of(angle, lost=missing))
    assert sum(found) == pytest.approx(-missing[-1], abs=3)


@pytest.mark.parametrize("configured", [500, 1000, 2048, 8000])
def test_wrong_counts_per_rev_show_at_every_revolution(configured: int) -> None:
    found = errors(blocks_of(turning(9.0)), configured)
    assert len(found) >= 4
    assert found == [pytest.approx(2000 - configured, abs=1)] * len(found)


@given(st.sampled_from([500, 1024, 2000, 4096]), st.sampled_from([4.0, -7.0, 9.9]))
@settings(deadline=None, max_examples=12)
def test_counts_per_rev_are_measured(counts_per_rev: int, speed_rad_s: float) -> None:
    measured = measure_counts_per_rev(blocks_of(turning(speed_rad_s), counts_per_rev), 24)
    assert measured.counts == pytest.approx(counts_per_rev, abs=1)
    assert measured.spread <= 2
    assert measured.revolutions == pytest.approx(abs(speed_rad_s) * 4 / (2 * pi) - 1, abs=1)


def test_counts_that_come_and_go_show_as_spread() -> None:
    angle = turning(9.0)
    blocks = blocks_of(angle, lost=lost_at_half(angle, 40))
    assert measure_counts_per_rev(blocks, 24).spread >= 38


def test_without_revolutions_or_index_there_is_nothing_to_measure() -> None:
    with pytest.raises(DaqError, match="no whole revolution"):
        measure_counts_per_rev(blocks_of(turning(1.0)), 24)
    with pytest.raises(DaqError, match="index_counter"):
        measure_counts_per_rev([SampleBlock(0, np.arange(10))], 24)
