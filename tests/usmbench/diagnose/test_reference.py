"""What the runs that a model was identified on tell beforehand."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import applied, driven
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

STEP_DEG = 0.7
GRID = applied("phase_quantisation", "rounded", step_deg=STEP_DEG)


def _driven(phases_deg: np.ndarray, seed: int, said_deg: float | None) -> Record:
    """Return a run of a generator with a grid, which its run.yaml may tell of."""
    record = driven(np.repeat(phases_deg, 10), seed, GRID)
    return replace(record, meta={"generator": {"phase_step_deg": said_deg}})


def _identified(said_deg: float | None) -> HammersteinModel:
    """Return a model of runs with too few phases to show a grid."""
    levels_deg = np.linspace(-90.0, 90.0, 37)
    rng = np.random.default_rng(1)
    records = [_driven(rng.permutation(np.tile(levels_deg, 5)), 30 + k, said_deg) for k in range(3)]
    return with_knowledge(identify_fast(records, FastOptions()).model, records)


@pytest.mark.parametrize("said_deg", [STEP_DEG, None], ids=["said", "unsaid"])
def test_a_generators_own_grid_is_no_news(said_deg: float | None) -> None:
    model = _identified(said_deg)
    assert bool(knowledge_of(model).habits) == (said_deg is not None)
    run = _driven(np.random.default_rng(2).uniform(-85.0, 85.0, 300), 40, said_deg)
    assert (diagnose([run], model).verdict == "no_discrepancy") == (said_deg is not None)


def test_runs_of_generators_that_differ_tell_of_no_grid() -> None:
    phases_deg = np.random.default_rng(3).permutation(np.linspace(-90.0, 90.0, 37))
    said_deg = {50: STEP_DEG, 51: 0.1}
    records = [_driven(np.tile(phases_deg, 5), seed, said) for seed, said in said_deg.items()]
    model = with_knowledge(identify_fast(records, FastOptions()).model, records)
    assert knowledge_of(model).habits == ()
