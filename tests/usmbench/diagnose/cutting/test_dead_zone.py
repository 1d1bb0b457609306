"""Where a model's motor stands."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.dead_zone import edge_of_standstill_deg
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.later_start import STANDING
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]

WINDOW_S, N = 0.01, 400
ANY = StaticCurve(np.array([-90.0, 90.0]), np.array([-10.0, 10.0]))


def _stretch(low_deg: float, high_deg: float) -> Stretch:
    """Return a stretch of a motor that stands between two phases."""
    point = OperatingPoint(None, None, ANY, (-90.0, 90.0), (None, None), 0.01)
    model = HammersteinModel(first_order(0.0035, 0.0015, WINDOW_S), (point,), "test")
    phase_deg = np.repeat(np.random.default_rng(3).uniform(-88.0, 88.0, N // 4), 4)
    t_s = WINDOW_S * np.arange(1.0, N + 1.0)
    record = Record("run", t_s, phase_deg, np.zeros(N), np.full(N, WINDOW_S))
    (stretch,), _ = cut_runs([record], model, ())

    def settled_rad_s(phase_deg: Array) -> Array:
        beyond_deg = np.maximum(phase_deg - high_deg, 0.0) + np.minimum(phase_deg - low_deg, 0.0)
        return np.asarray(10.0 * np.tanh(beyond_deg / 25.0))

    context = replace(stretch.context, settled_rad_s=settled_rad_s)
    return replace(stretch, context=context, settled_rad_s=settled_rad_s(context.phase_deg))


@given(st.floats(-30.0, 0.0), st.floats(0.0, 30.0))
def test_its_ends_are_found_on_both_sides(low_deg: float, high_deg: float) -> None:
    stretch = _stretch(low_deg, high_deg)
    phase_deg, found = stretch.context.phase_deg, edge_of_standstill_deg(stretch)
    creeps_deg = 25.0 * np.arctanh(STANDING)
    assert found[phase_deg > 0.0] == pytest.approx(high_deg + creeps_deg, abs=0.1)
    assert found[phase_deg < 0.0] == pytest.approx(-low_deg + creeps_deg, abs=0.1)
    assert edge_of_standstill_deg(stretch, 1e-4)[0] == pytest.approx(found[0] - creeps_deg, abs=0.1)
