"""The size that a test told the form needs, and the fit of a share of 90 %."""

import math

import pytest
from scipy.stats import norm

from benchmarks.campaign_bench import MotorBench
from benchmarks.campaign_runs import Excited
from benchmarks.naming_power import MULTIPLES, Hits, Power, size_of_90_percent


def test_a_longer_run_needs_a_smaller_size(motor_bench: MotorBench) -> None:
    short_s, long_s = (
        Power(motor_bench, Excited("staircase", duration_s, 5)).told_size("eccentric_disc")
        for duration_s in (3.0, 6.0)
    )
    assert 0.0 < long_s < short_s < 30.0


def test_a_large_cause_is_named(motor_bench: MotorBench) -> None:
    power = Power(motor_bench, Excited("staircase", 3.0, 5))
    assert power.named("dead_direction", 1.0, 1) == Hits(first=1, in_set=1)


def test_the_fit_finds_the_size_of_90_percent() -> None:
    # Shares that follow a probit with slope 3 around a size of 2.
    shares = [norm.cdf(3.0 * math.log(multiple / 2.0)) for multiple in MULTIPLES]
    n = 10_000
    found = size_of_90_percent(MULTIPLES, [round(n * share) for share in shares], n)
    assert found == pytest.approx(2.0 * math.exp(norm.isf(0.1) / 3.0), rel=0.02)


def test_the_fit_stays_finite_where_all_or_none_are_named() -> None:
    n_sizes = len(MULTIPLES)
    assert 0.1 < size_of_90_percent(MULTIPLES, [6] * n_sizes, 6) < 1.0
    assert 5.0 < size_of_90_percent(MULTIPLES, [0] * n_sizes, 6) < 100.0
