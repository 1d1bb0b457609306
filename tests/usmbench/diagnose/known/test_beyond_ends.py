"""What a curve may be off by beyond its ends."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.beyond_ends import beyond_ends
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.known.phase_nodes import PHASE_NODES

TOP_RAD_S = 6.0


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
