"""The small version of the day: memory is flat over a few minutes."""

import pytest

from benchmarks import memory_24h


def test_memory_is_flat_over_simulated_minutes() -> None:
    assert memory_24h.growth(memory_24h.sweep_hours(0.05)) < memory_24h.GOAL


def test_growth_would_be_seen() -> None:
    flat = [100.0, 140.0, 140.0, 141.0, 141.0, 141.0, 142.0]
    assert memory_24h.growth(flat) == pytest.approx(142.0 / 141.0)
    assert memory_24h.growth([*flat, 160.0]) > memory_24h.GOAL
