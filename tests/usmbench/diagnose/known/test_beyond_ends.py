"""What a curve may be off by beyond its ends."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from known_motor import LINEAR, WINDOW_S
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.beyond_ends import beyond_ends
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.known.phase_nodes import PHASE_NODES
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

NOISE_RAD_S, TOP_RAD_S, END_DEG = 0.01, 6.0, 89.0


def _ending_at(low_deg: float, high_deg: float) -> Features:
    return Features(tuple(np.linspace(low_deg, high_deg, PHASE_NODES).tolist()), TOP_RAD_S)


def test_two_deviations_are_all_that_a_curve_goes_on_by(stretches: list[Stretch]) -> None:
    (stretch,) = stretches
    phase_deg, settled = stretch.context.phase_deg, stretch.lag == 4
    (columns,) = beyond_ends(stretches, _ending_at(-60.0, 70.0))
    for column, beyond, end_deg in zip(
        columns.T, (phase_deg < -60.0, phase_deg > 70.0), (-60.0, 70.0), strict=True
    ):
        at_end = np.full(phase_deg.shape, end_deg)
        goes_on = stretch.context.settled_rad_s(phase_deg) - stretch.context.settled_rad_s(at_end)
        assert np.any(beyond & settled)
        assert 2.0 * column[settled] == pytest.approx((goes_on * beyond)[settled], abs=1e-3)


def test_within_the_ends_there_is_none(stretches: list[Stretch]) -> None:
    (columns,) = beyond_ends(stretches, features_of(stretches))
    assert columns.shape == (stretches[0].context.n, 0)


def test_what_one_stretch_passes_has_a_column_in_each(stretches: list[Stretch]) -> None:
    (passing,) = stretches
    phase_deg = np.clip(passing.context.phase_deg, -70.0, 50.0)
    staying = replace(passing, context=replace(passing.context, phase_deg=phase_deg))
    shapes = [c.shape[1] for c in beyond_ends([staying, passing], _ending_at(-90.0, 60.0))]
    assert shapes == [1, 1]


def _ramp_rad_s(phase_deg: NDArray[np.float64]) -> NDArray[np.float64]:
    """Settled speed of a motor that saturates where its references end."""
    share = np.clip((np.abs(phase_deg) - 25.0) / (END_DEG - 25.0), 0.0, 1.0)
    return TOP_RAD_S * np.sign(phase_deg) * share


def _driven(seed: int, *ends_deg: float, most_deg: float) -> Record:
    rng = np.random.default_rng(seed)
    levels_deg = np.r_[rng.uniform(-most_deg, most_deg, 100), ends_deg]
    phase_deg: NDArray[np.float64] = np.repeat(rng.permutation(levels_deg), 6)
    settled_rad_s = _ramp_rad_s(phase_deg)
    noise_rad_s = NOISE_RAD_S * rng.standard_normal(phase_deg.size)
    speed_rad_s = free_run(LINEAR, settled_rad_s, float(settled_rad_s[0])) + noise_rad_s
    t_s = WINDOW_S * np.arange(1.0, phase_deg.size + 1.0)
    return Record(f"run {seed}", t_s, phase_deg, speed_rad_s, np.full(t_s.size, WINDOW_S))


@pytest.fixture(scope="module")
def saturating() -> HammersteinModel:
    references = [_driven(k, -END_DEG, END_DEG, most_deg=END_DEG) for k in range(3)]
    return with_knowledge(identify_fast(references, FastOptions(12)).model, references)


def test_a_motor_that_saturates_where_its_references_end_loses_no_counts(
    saturating: HammersteinModel,
) -> None:
    ends_deg = (-90.0, -89.8, -89.6, 89.5, 89.7, 90.0)
    found = diagnose([_driven(11, *ends_deg, most_deg=END_DEG)], saturating)
    assert (found.verdict, found.causes) == ("no_discrepancy", ())
