"""The test that knows what a mechanism does."""

import numpy as np
import pytest

from benchmarks.campaign_bench import MotorBench
from benchmarks.campaign_runs import Excited
from benchmarks.told_test import LENGTH, told_length, told_power
from usmbench.runs.reader import read_run


def test_it_finds_nine_of_ten_effects_of_its_length() -> None:
    assert told_power(LENGTH) == pytest.approx(0.9, abs=1e-3)
    assert told_power(0.0) == pytest.approx(0.025)


def test_a_length_grows_with_the_effect_and_the_windows(motor_bench: MotorBench) -> None:
    record = read_run(motor_bench.measured(Excited("staircase", 10.0, 5), 0))
    found = motor_bench.searched(record)
    effect = 0.01 * np.random.default_rng(1).standard_normal(record.t_s.size)

    def length(times: float, until_s: float = 1e9) -> float:
        windows = record.t_s < record.t_s[0] + until_s
        return told_length(times * np.stack([effect, effect]), record, found, windows)

    slow = 0.01 * np.sqrt(2.0) * np.sin(2.0 * np.pi * record.t_s)
    # Which the noise and the model's own error hide more of.
    assert told_length(np.stack([slow, slow]), record, found) < 0.7 * length(1.0)
    assert length(2.0) == pytest.approx(2.0 * length(1.0))
    assert length(1.0, until_s=5.0) < 0.8 * length(1.0)
    assert told_length(np.stack([effect, effect]), record, found) == pytest.approx(length(1.0))
