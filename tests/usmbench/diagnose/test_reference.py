"""What the runs that a model was identified on tell beforehand."""

import numpy as np

from tests.usmbench.diagnose.gridded_runs import STEP_DEG, gridded_run
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast


def test_runs_of_generators_that_differ_tell_of_no_grid() -> None:
    phases_deg = np.random.default_rng(3).permutation(np.linspace(-90.0, 90.0, 37))
    said_deg = {50: STEP_DEG, 51: 0.1}
    records = [gridded_run(np.tile(phases_deg, 5), seed, said) for seed, said in said_deg.items()]
    model = with_knowledge(identify_fast(records, FastOptions()).model, records)
    assert knowledge_of(model).habits == ()
