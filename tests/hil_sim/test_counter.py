"""Counter registers of the two families, and the sensor."""

import numpy as np
import pytest

from hil_sim.counter import Counter, Family, card_counter, sensor_volts
from hil_sim.faults import Fault, FaultKind, FaultSchedule

POSITION = np.array([-5, -4, -1, 0, 3, 4, 9])


def test_x4_wraps_at_32_bits() -> None:
    values = card_counter("m_x", FaultSchedule()).values(POSITION)
    assert values.tolist() == [2**32 - 5, 2**32 - 4, 2**32 - 1, 0, 3, 4, 9]


def test_x1_counts_whole_lines_in_24_bits() -> None:
    values = card_counter("e_series", FaultSchedule()).values(POSITION)
    assert values.tolist() == [2**24 - 2, 2**24 - 1, 2**24 - 1, 0, 0, 1, 2]


@pytest.mark.parametrize(("family", "bits", "x4"), [("m_x", 32, 1), ("e_series", 24, 4)])
def test_a_preset_wraps_after_as_many_counts(family: Family, bits: int, x4: int) -> None:
    schedule = FaultSchedule([Fault(FaultKind.COUNTER_WRAP, 0.0, counts=3)])
    values = card_counter(family, schedule).values(x4 * np.arange(6))
    assert values.tolist() == [2**bits - 3, 2**bits - 2, 2**bits - 1, 0, 1, 2]


def test_differences_survive_any_width() -> None:
    rng = np.random.default_rng(0)
    position = np.cumsum(rng.integers(-100, 100, 2000))
    for bits in (12, 16, 24):
        step = np.diff(Counter("m_x", bits, 77).values(position))
        half = 1 << bits - 1
        assert np.array_equal((step + half) % (1 << bits) - half, np.diff(position))


def test_the_mean_of_equal_readings_is_the_reading() -> None:
    for temperature_c in np.random.default_rng(1).uniform(0, 100, 50):
        volts = sensor_volts(float(temperature_c))
        assert np.mean(np.full(1000, volts)) == volts
        assert volts * 100 == pytest.approx(temperature_c, abs=1e-3)
