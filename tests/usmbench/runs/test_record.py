"""What a run in memory tells of the bench it was measured on."""

import math
from typing import Any

import numpy as np
import pytest

from usmbench.runs.record import Record


def _measured(meta: dict[str, Any]) -> Record:
    column = np.ones(3)
    return Record("run", column, column, column, column, meta=meta)


def test_a_count_is_a_share_of_the_revolution() -> None:
    record = _measured({"encoder": {"counts_per_rev": 2000}})
    assert record.count_rad == pytest.approx(math.pi / 1000.0)


@pytest.mark.parametrize(("jitter", "off"), [(0.0, 0.0), (0.1, 2e-3)])
def test_a_window_lasts_as_long_as_most_do(jitter: float, off: float) -> None:
    window_s = 0.01 * (1.0 + jitter * np.random.default_rng(1).uniform(-1.0, 1.0, 2000))
    window_s[[5, 900]] = 3.0, 0.4  # pauses
    record = Record("run", np.cumsum(window_s), window_s, window_s, window_s)
    assert record.usual_window_s == pytest.approx(0.01, rel=off, abs=0.0)


@pytest.mark.parametrize("encoder", [None, {}, {"counts_per_rev": None}])
def test_counts_that_nobody_says_leave_the_count_unknown(encoder: object) -> None:
    assert _measured({"encoder": encoder}).count_rad is None


def test_a_bare_table_leaves_the_count_unknown() -> None:
    assert _measured({}).count_rad is None


@pytest.mark.parametrize(
    ("generator", "step_deg"), [({"phase_step_deg": 0.1}, 0.1), ({}, None), (None, None)]
)
def test_a_run_may_say_the_step_of_its_generators_phases(
    generator: object, step_deg: float | None
) -> None:
    assert _measured({"generator": generator}).phase_step_deg == step_deg
