"""The size that a test told the form needs, and the one from which on a share of 90 % is named."""

import math

import pytest

from benchmarks.campaign_bench import MotorBench
from benchmarks.campaign_runs import Excited
from benchmarks.naming_power import MULTIPLES, Hits, Power, size_of_90_percent


def test_a_large_cause_is_named(motor_bench: MotorBench) -> None:
    power = Power(motor_bench, Excited("staircase", 3.0, 5))
    assert power.named("dead_direction", 1.0, 1) == Hits(first=1, in_set=1)


def test_90_percent_lie_between_the_sizes_that_name_less_and_more() -> None:
    found = size_of_90_percent((1.0, 1.5, 2.0), [16, 17, 19], 20)
    assert found == pytest.approx(1.5 * (2.0 / 1.5) ** 0.5)


def test_a_miss_of_a_large_size_counts_for_the_smaller_ones_too() -> None:
    multiples = (1.0, 1.5, 2.0, 3.0)
    assert size_of_90_percent(multiples, [0, 20, 19, 20], 20) == pytest.approx(1.5 ** (18.0 / 19.5))
    assert size_of_90_percent(multiples, [0, 18, 16, 20], 20) == pytest.approx(2.0 * 1.5 ** (1 / 3))


def test_where_all_or_none_are_named_90_percent_lie_at_the_first_size_or_nowhere() -> None:
    n_sizes = len(MULTIPLES)
    assert size_of_90_percent(MULTIPLES, [9] * n_sizes, 10) == MULTIPLES[0]
    assert size_of_90_percent(MULTIPLES, [0] * n_sizes, 6) == math.inf
