"""Which rows of a run are judged."""

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis.strategies import integers, lists, sampled_from, tuples

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.errors import InputError
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record


@settings(
    deadline=None, max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    parts=lists(
        tuples(integers(1, 100), sampled_from((20, 45, 50, 60, 400, 1500))), min_size=1, max_size=5
    )
)
@example(parts=[(100, 50), (1, 1000)])
@example(parts=[(20, 45), (1, 600)])
def test_of_a_long_run_with_gaps_no_row_is_judged_twice(
    model: HammersteinModel, parts: list[tuple[int, int]]
) -> None:
    lengths = [length for times, length in parts for _ in range(times)]
    lengths *= 1 + 6000 // sum(lengths)
    n = sum(lengths)
    phase_deg = np.repeat(np.random.default_rng(5).uniform(-88.0, 88.0, n // 5 + 1), 5)[:n]
    t_s = 0.01 * np.arange(1.0, n + 1.0) + np.repeat(10.0 * np.arange(len(lengths)), lengths)
    speed_rad_s = model.points[0].curve.speed_rad_s(phase_deg)
    record = Record("run", t_s, phase_deg, speed_rad_s, np.full(n, 0.01))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("usmbench.diagnose.cutting.cut_runs._MOST_WINDOWS", 4000)
        if max(lengths) <= 50:
            with pytest.raises(InputError, match="usable windows"):
                cut_runs([record], model, ())
            return
        stretches, _ = cut_runs([record], model, ())
    assert all(s.context.n > 0 for s in stretches)
    judged_s = np.concatenate([s.context.t_s for s in stretches])
    assert np.unique(judged_s).size == judged_s.size <= 1.2 * 4000
