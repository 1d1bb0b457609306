"""A motor with a dead zone, driven through phases that are held, without its noise."""

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.model.effects.first_order import first_order
from usmbench.model.hammerstein import HammersteinModel, OperatingPoint, StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]
WINDOW_S, NOISE_RAD_S, HOLD = 0.01, 0.01, 4
PHASE_DEG = np.linspace(-90.0, 90.0, 181)
CREST_RAD_S = 10.0 * np.sin(np.radians(PHASE_DEG))
CURVE = StaticCurve(PHASE_DEG, np.sign(PHASE_DEG) * np.maximum(np.abs(CREST_RAD_S) - 1.7, 0.0))
MODEL = HammersteinModel(
    first_order(0.0035, 0.0015, WINDOW_S),
    (OperatingPoint(None, None, CURVE, (-90.0, 90.0), (None, None), NOISE_RAD_S),),
    "test",
)


def held_phases(levels_deg: Array, hold: int = HOLD) -> Stretch:
    """Return a run that holds each phase for some windows."""
    phase_deg = np.repeat(levels_deg, hold)
    n = phase_deg.size
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    record = Record("run", t_s, phase_deg, np.zeros(n), np.full(n, WINDOW_S))
    (stretch,), _ = cut_runs([record], MODEL, ())
    return stretch
