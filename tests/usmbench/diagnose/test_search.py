"""Which windows a search sets aside as exceptions."""

import numpy as np
import pytest
from numpy.typing import NDArray

from known_motor import NOISE_RAD_S, applied, driven, identified
from usmbench.diagnose.cut_runs import cut_runs
from usmbench.diagnose.found import Found
from usmbench.diagnose.pipeline import own_effects, searched
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

DELAY = applied("transport_delay", "", delay_s=0.003)


@pytest.fixture(scope="module")
def model() -> HammersteinModel:
    return identified()


def _searched(record: Record, model: HammersteinModel) -> Found:
    return searched(cut_runs([record], model, own_effects(model))[0], model)


def _names(found: Found) -> set[str]:
    return {ranking[0].effect.name for ranking in found.named}


def _judged(found: Found, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return which of some rows of the run are judged, those aside that none ever is."""
    ((stretch,), (mask,)) = found.problem.stretches, found.problem.masks
    judged: NDArray[np.bool_] = mask[rows[stretch.use[rows]]]
    return judged


def test_what_a_delay_leaves_in_one_window_a_stair_is_judged(model: HammersteinModel) -> None:
    stairs = np.linspace(-86.0, 86.0, 25)
    phase_deg = np.repeat(np.r_[stairs, stairs[::-1]], 60)
    offset = applied("phase_offset", "", offset_deg=0.6)
    found = _searched(driven(phase_deg, 31, offset, DELAY), model)
    assert _names(found) == {"phase_offset", "transport_delay"}
    assert _judged(found, np.flatnonzero(np.diff(phase_deg)) + 1).all()


def test_false_counts_beside_a_delay_are_exceptions(model: HammersteinModel) -> None:
    rng = np.random.default_rng(32)
    record = driven(np.repeat(rng.uniform(-88.0, 88.0, 500), 4), 32, DELAY)
    false = rng.choice(record.t_s.size, 20, replace=False)
    record.speed_rad_s[false] += 50.0 * NOISE_RAD_S
    found = _searched(record, model)
    assert _names(found) == {"transport_delay"}
    assert not _judged(found, false).any()
