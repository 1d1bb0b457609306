"""A large effect in a small naming campaign, with what it gains on a fresh run."""

import pytest

from benchmarks.campaign_bench import MotorBench
from benchmarks.campaign_draws import Draw, Hidden
from benchmarks.campaign_runs import Excited

SHORT = Excited("staircase", 10.0, 5)


def test_a_large_scale_error_is_named_with_its_size_and_gain(motor_bench: MotorBench) -> None:
    hidden = Hidden("single", ("other_code_wheel=25.0",), ("speed_scale",), 30.0)
    outcome = motor_bench.diagnosed(Draw(4, hidden, SHORT, wire=False))
    assert "speed_scale" in {*outcome.named, *outcome.alternatives}
    assert outcome.oracle_gain == pytest.approx(1.0, abs=0.2)
    assert outcome.fresh_gain is not None
    assert outcome.fresh_gain == pytest.approx(outcome.oracle_gain, abs=0.2)
    truth, _, value, _ = outcome.intervals["scale_error"]
    assert truth == 0.05
    assert value == pytest.approx(truth, abs=0.01)
