"""The size that a test told the form needs."""

from benchmarks.campaign_bench import MotorBench
from benchmarks.campaign_runs import Excited
from benchmarks.naming_power import Power


def test_a_longer_run_needs_a_smaller_size(motor_bench: MotorBench) -> None:
    short_s, long_s = (
        Power(motor_bench, Excited("staircase", duration_s, 5)).told_size("eccentric_disc")
        for duration_s in (3.0, 6.0)
    )
    assert 0.0 < long_s < short_s < 30.0
