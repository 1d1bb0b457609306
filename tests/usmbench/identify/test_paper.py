"""The paper's algorithm on pairs of a known curve."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from usmbench.errors import InputError
from usmbench.identify.paper import (
    KNOTS_BOTH_WAYS_DEG,
    KNOTS_ONE_WAY_DEG,
    PaperOptions,
    identify_paper,
)
from usmbench.identify.paper_lm import LmOptions
from usmbench.model.hammerstein import StaticCurve
from usmbench.runs.record import Pairs, Record

CURVE = StaticCurve(
    np.array(KNOTS_BOTH_WAYS_DEG),
    np.sign(np.arange(-9.0, 10.0)) * np.sqrt(np.abs(np.arange(-9.0, 10.0))),
)


def pairs_run(phase_deg: np.ndarray, speed_rad_s: np.ndarray, n_windows: float = 20.0) -> Record:
    n = phase_deg.size
    ones, unknown = np.ones(n), np.full(n, np.nan)
    pairs = Pairs(
        phase_deg,
        unknown,
        unknown,
        speed_rad_s,
        ones,
        n_windows * ones,
        ones,
        np.arange(1.0, n + 1),
    )
    return Record("pairs", np.arange(1.0, n + 1), phase_deg, speed_rad_s, ones, pairs=pairs)


@pytest.fixture
def forty() -> Record:
    phase_deg = np.linspace(-90.0, 90.0, 40)
    return pairs_run(phase_deg, CURVE.speed_rad_s(phase_deg))


def test_a_curve_of_its_own_kind_is_found_exactly(forty: Record) -> None:
    found = identify_paper([forty], PaperOptions()).found
    assert found.scores[0].sse < 1e-12
    curve = found.model.points[0].curve
    assert curve.knots_deg.tolist() == list(KNOTS_BOTH_WAYS_DEG)
    assert np.allclose(curve.speed_rad_s(forty.phase_deg), forty.speed_rad_s, atol=1e-6)
    assert found.model.linear.gain == pytest.approx(1.0, abs=1e-12)


def test_the_same_seed_walks_the_same_way(forty: Record) -> None:
    first, second = (identify_paper([forty], PaperOptions(seed=3)) for _ in range(2))
    assert first.result.trace == second.result.trace
    other = identify_paper([forty], PaperOptions(seed=4))
    assert other.result.trace != first.result.trace


def test_the_trace_follows_the_paper(forty: Record) -> None:
    options = PaperOptions(search=LmOptions(alpha=2.0, damping=1e-3))
    trace = identify_paper([forty], options).result.trace
    accepted = [step for step in trace if step.accepted]
    assert all(later.sse < earlier.sse for earlier, later in pairwise(accepted))
    factor = 2.0
    for step, following in pairwise(trace):
        if step.accepted:
            growth, factor = max(1 / 3, 1 - (2 * step.gain_ratio - 1) ** 3), 2.0
        else:
            growth, factor = factor, 2.0 * factor
        assert following.damping == pytest.approx(step.damping * growth)


def test_a_linear_problem_is_predicted_exactly(forty: Record) -> None:
    options = PaperOptions(nb=0, search=LmOptions(damping=1e-9))
    last = [s for s in identify_paper([forty], options).result.trace if s.accepted][1:4]
    assert all(0.5 < step.gain_ratio < 1.5 for step in last)


def test_dynamics_in_the_pairs_are_found() -> None:
    rng = np.random.default_rng(0)
    phase_deg = rng.uniform(-90.0, 90.0, 300)
    speed_rad_s = np.empty(300)
    previous = 0.0
    for k, settled in enumerate(CURVE.speed_rad_s(phase_deg)):
        previous = 0.4 * previous + 0.6 * settled
        speed_rad_s[k] = previous
    found = identify_paper([pairs_run(phase_deg, speed_rad_s)], PaperOptions()).found
    assert found.model.linear.a.tolist() == pytest.approx([-0.4], abs=1e-6)
    assert found.model.linear.b.tolist() == pytest.approx([0.6], abs=1e-6)
    assert found.scores[0].sse < 1e-9


def test_one_way_data_take_the_knots_of_the_other_figures() -> None:
    phase_deg = np.linspace(0.0, 90.0, 40)
    record = pairs_run(phase_deg, np.maximum(phase_deg - 60.0, 0.0) / 5.0)
    found = identify_paper([record], PaperOptions()).found
    assert found.to_json()["knots_deg"] == list(KNOTS_ONE_WAY_DEG)


def test_unsettled_pairs_are_left_out_with_a_warning(forty: Record) -> None:
    assert forty.pairs is not None
    forty.pairs.n_windows[3:6] = 0.0
    found = identify_paper([forty], PaperOptions()).found
    assert "3 dwells without a settled window left out" in found.warnings[0]
    assert found.scores[0].n == 37


def test_too_few_pairs_are_refused_with_the_numbers() -> None:
    phase_deg = np.linspace(-90.0, 90.0, 12)
    with pytest.raises(InputError, match="12 settled pairs cannot carry 20 parameters"):
        identify_paper([pairs_run(phase_deg, phase_deg / 9.0)], PaperOptions())


def test_the_fast_methods_data_serve_too(measure: Callable[..., Record]) -> None:
    found = identify_paper([measure(400)], PaperOptions()).found
    assert "no settled pairs" in found.warnings[0]
