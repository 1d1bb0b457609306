"""Radians, milliseconds and rpm are asked about; what a bench measures is not."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.runs.doubtful_units import doubtful_units
from usmbench.runs.record import Record

PHASE_DEG = np.linspace(-90.0, 90.0, 50)
RUN = Record(
    "a run", 0.01 * np.arange(1.0, 51.0), PHASE_DEG, 0.1 * PHASE_DEG, np.full(PHASE_DEG.size, 0.01)
)


def test_what_a_bench_measures_is_not_asked_about() -> None:
    held = replace(RUN, phase_deg=np.full(PHASE_DEG.size, 2.0))
    assert doubtful_units([RUN, held]) == []


@pytest.mark.parametrize(
    ("other", "unit"),
    [
        (replace(RUN, phase_deg=np.radians(PHASE_DEG)), "radians"),
        (replace(RUN, t_s=1000.0 * RUN.t_s, window_s=1000.0 * RUN.window_s), "milliseconds"),
        (replace(RUN, t_s=1000.0 * RUN.t_s), "milliseconds"),
        (replace(RUN, speed_rad_s=9.55 * RUN.speed_rad_s), "rpm"),
    ],
)
def test_another_unit_is_asked_about(other: Record, unit: str) -> None:
    (asked,) = doubtful_units([RUN, other])
    assert asked.startswith("a run: ")
    assert unit in asked
