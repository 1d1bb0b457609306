"""The shapes that a model may leave."""

import numpy as np
import pytest

from usmbench.diagnose.features_of_runs import features_of
from usmbench.diagnose.shapes import hats
from usmbench.diagnose.stretches import Stretch
from usmbench.model.linear import free_run


def test_a_curve_that_is_off_shows_as_the_linear_part_lets_it(stretches: list[Stretch]) -> None:
    (stretch,) = stretches
    features = features_of(stretches)
    off = np.column_stack(list(hats(stretch.context.phase_deg, np.array(features.nodes_deg))))
    driven = np.flatnonzero(off[stretch.use].sum(axis=0) > 3.0)
    columns = np.column_stack(list(features.columns(stretch)))
    linear, settled, used = stretch.context.linear, stretch.settled_rad_s, stretch.use
    assert driven.size > 20
    for k in driven:
        change = free_run(linear, settled + off[:, k]) - free_run(linear, settled)
        assert np.max(np.abs(off[:, k] - change)[used]) > 0.1  # a step shows but part of it
        assert columns[used, k] == pytest.approx(change[used], abs=2e-3)
