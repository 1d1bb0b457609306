"""What a curve may be off by beyond its ends."""

import numpy as np
import pytest
from numpy.typing import NDArray

from known_motor import LINEAR, WINDOW_S
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.reference import with_knowledge
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.linear import free_run
from usmbench.runs.record import Record

NOISE_RAD_S, TOP_RAD_S, END_DEG = 0.01, 6.0, 89.0


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
