"""What the runs that a model was identified on tell beforehand."""

from dataclasses import replace

import numpy as np

from tests.usmbench.diagnose.gridded_runs import STEP_DEG, gridded_run
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.runs.record import Record


def test_runs_of_generators_that_differ_tell_of_no_grid() -> None:
    phases_deg = np.random.default_rng(3).permutation(np.linspace(-90.0, 90.0, 37))
    said_deg = {50: STEP_DEG, 51: 0.1}
    records = [gridded_run(np.tile(phases_deg, 5), seed, said) for seed, said in said_deg.items()]
    model = with_knowledge(identify_fast(records, FastOptions()).model, records)
    assert knowledge_of(model).habits == ()


def test_runs_that_were_computed_teach_as_measured_ones_do() -> None:
    phase_deg = np.repeat(np.random.default_rng(1).uniform(-80.0, 80.0, 60), 10)
    n = phase_deg.size
    t_s, window_s = 0.01 * np.arange(1.0, n + 1.0), np.full(n, 0.01)
    record = Record("computed", t_s, phase_deg, 0.1 * phase_deg, window_s)
    model = with_knowledge(identify_fast([record], FastOptions()).model, [record])
    assert diagnose([record], model).verdict == "no_discrepancy"
    faster = diagnose([replace(record, speed_rad_s=1.02 * record.speed_rad_s)], model)
    assert [cause.name for cause in faster.causes] == ["speed_scale"]
