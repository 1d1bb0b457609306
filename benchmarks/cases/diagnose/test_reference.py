"""What the runs that a model was identified on tell beforehand."""

from dataclasses import replace

import numpy as np
import pytest

from tests.usmbench.diagnose.gridded_runs import STEP_DEG, gridded_run
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record


def _identified(said_deg: float | None) -> HammersteinModel:
    """Return a model of runs with too few phases to show a grid."""
    levels_deg = np.linspace(-90.0, 90.0, 37)
    rng = np.random.default_rng(1)
    records = [
        gridded_run(rng.permutation(np.tile(levels_deg, 5)), 30 + k, said_deg) for k in range(3)
    ]
    return with_knowledge(identify_fast(records, FastOptions()).model, records)


@pytest.mark.parametrize("said_deg", [STEP_DEG, None], ids=["said", "unsaid"])
def test_a_generators_own_grid_is_no_news(said_deg: float | None) -> None:
    model = _identified(said_deg)
    assert bool(knowledge_of(model).habits) == (said_deg is not None)
    run = gridded_run(np.random.default_rng(2).uniform(-85.0, 85.0, 300), 40, said_deg)
    assert (diagnose([run], model).verdict == "no_discrepancy") == (said_deg is not None)


def test_runs_that_were_computed_teach_as_measured_ones_do() -> None:
    phase_deg = np.repeat(np.random.default_rng(1).uniform(-80.0, 80.0, 60), 10)
    n = phase_deg.size
    t_s, window_s = 0.01 * np.arange(1.0, n + 1.0), np.full(n, 0.01)
    record = Record("computed", t_s, phase_deg, 0.1 * phase_deg, window_s)
    model = with_knowledge(identify_fast([record], FastOptions()).model, [record])
    assert diagnose([record], model).verdict == "no_discrepancy"
    faster = diagnose([replace(record, speed_rad_s=1.02 * record.speed_rad_s)], model)
    assert [cause.name for cause in faster.causes] == ["speed_scale"]
