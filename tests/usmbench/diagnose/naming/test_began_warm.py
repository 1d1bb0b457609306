"""A motor that warms, and is warm already when a run begins."""

from dataclasses import replace

import numpy as np
import pytest

from tests.usmbench.diagnose.naming.warming_motor import driven, known_cold
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.model.hammerstein import HammersteinModel


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return known_cold()


def test_each_run_that_may_have_begun_warm_may_have_begun_otherwise(
    model: HammersteinModel,
) -> None:
    stretches, _ = cut_runs([driven(16), driven(17)], model, ())
    cold = knowledge_of(model)
    warm = replace(cold, began_warm=("run 16",))
    (plain, plain_root), (shapes, root) = (k.background(stretches) for k in (cold, warm))
    n_more = int(np.count_nonzero(cold.features.warms_at >= 0))
    assert shapes[0].shape[1] == plain[0].shape[1] + 2 * n_more
    assert root.shape[0] == plain_root.shape[0] + 2 * n_more
    more = np.linalg.norm(shapes[0] @ root, axis=1) > np.linalg.norm(plain[0] @ plain_root, axis=1)
    assert np.mean(more) > 0.8
