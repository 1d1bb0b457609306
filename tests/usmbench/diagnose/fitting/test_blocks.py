"""Blocks that a fit does not see, and what is left for it."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.fitting.blocks import FOLDS, block_of, held_apart
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import memory_windows
from usmbench.runs.record import Record


@pytest.mark.parametrize(("tau_s", "n"), [(0.0035, 200), (0.0035, 2000), (0.2, 600), (0.2, 4000)])
def test_each_row_is_scored_once_by_a_fit_of_others_that_are_not_tied_to_it(
    model: HammersteinModel, tau_s: float, n: int
) -> None:
    slow = replace(model, linear=first_order(tau_s, 0.0, 0.01))
    phase_deg = np.repeat(np.random.default_rng(0).uniform(-88.0, 88.0, n // 5), 5)
    record = Record(
        "run", 0.01 * np.arange(1.0, n + 1.0), phase_deg, 0.1 * phase_deg, np.full(n, 0.01)
    )
    (stretch,), _ = cut_runs([record], slow, ())
    folds = [held_apart(stretch, fold) for fold in range(FOLDS)]
    assert np.array_equal(np.sum([scored for scored, _ in folds], axis=0), np.ones(n))
    memory = memory_windows(slow.linear)
    for scored, left_out in folds:
        fitted = np.flatnonzero(~left_out)
        assert fitted.size > 0.1 * n
        apart = np.abs(fitted[:, None] - np.flatnonzero(scored)).min()
        assert apart > memory
    assert np.max(block_of(stretch)) == 11
