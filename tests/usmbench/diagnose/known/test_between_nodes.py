"""What a curve's known error may be between two nodes."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.between_nodes import between_nodes, deviations_rad_s
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.known.phase_nodes import PHASE_NODES

NODES_DEG = tuple(float(node) for node in np.linspace(-72.0, 72.0, PHASE_NODES))
FEATURES = Features(NODES_DEG, 10.0)
N_SHAPES = len(FEATURES.groups)


def _kink(corner_deg: float, phase_deg: Sequence[float]) -> NDArray[np.float64]:
    return 0.1 * np.maximum(np.array(phase_deg) - corner_deg, 0.0)


@settings(deadline=None)
@given(st.floats(-60.0, 60.0))
def test_a_corner_between_nodes_is_within_two_deviations(corner_deg: float) -> None:
    mean = np.zeros(N_SHAPES)
    mean[:PHASE_NODES] = _kink(corner_deg, NODES_DEG)
    (off,) = deviations_rad_s(FEATURES, mean, np.zeros((N_SHAPES, N_SHAPES)))
    phase_deg = np.linspace(-72.0, 72.0, 14401)
    straight = np.interp(phase_deg, NODES_DEG, mean[:PHASE_NODES])
    error = np.abs(straight - _kink(corner_deg, list(phase_deg)))
    interval = np.clip(np.searchsorted(NODES_DEG, phase_deg) - 1, 0, PHASE_NODES - 2)
    assert np.all(error <= 2.0 * off[interval] + 4e-3)
    assert np.count_nonzero(off > 1e-9) <= 3


def test_a_corner_that_chance_explains_is_none() -> None:
    mean = np.zeros(N_SHAPES)
    mean[:PHASE_NODES] = _kink(10.0, NODES_DEG)
    assert not np.any(deviations_rad_s(FEATURES, mean, 0.3 * np.eye(N_SHAPES)))


def test_it_acts_between_these_nodes_alone(stretches: list[Stretch]) -> None:
    (stretch,) = stretches
    features = features_of(stretches)
    off_rad_s, widest = np.zeros((1, PHASE_NODES - 1)), int(np.argmax(np.diff(features.nodes_deg)))
    off_rad_s[0, widest] = 0.2
    (column,) = between_nodes(stretch, features, off_rad_s).T
    phase_deg, settled = stretch.context.phase_deg, stretch.lag == 4
    low_deg, high_deg = features.nodes_deg[widest : widest + 2]
    inside = (phase_deg > low_deg) & (phase_deg < high_deg)
    assert np.any(inside & settled)
    share = (phase_deg - low_deg) / (high_deg - low_deg)
    arch = np.where(inside, 0.8 * share * (1.0 - share), 0.0)
    assert column[settled] == pytest.approx(arch[settled], abs=2e-3)
    assert between_nodes(stretch, features, 1e-3 * off_rad_s)[:, 0] == pytest.approx(1e-3 * column)
