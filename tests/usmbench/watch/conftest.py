"""A run that grows row by row, and a model beside it."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.model.hammerstein import HammersteinModel, LinearPart, OperatingPoint, StaticCurve
from usmbench.runs.writer import RunWriter
from usmbench.sweep.rows import PairRow, WindowRow

WINDOW_S = 0.01


class GrowingRun:
    """A run folder as a sweep writes it; the speed is a tenth of the phase."""

    def __init__(self, folder: Path, **meta: Any):
        encoder = {"counts_per_rev": 2000, "sample_rate_hz": 1e5, "samples_per_average": 1000}
        head = {"motor": "Shinsei USR60", "encoder": encoder, **meta}
        self.folder = folder
        self.writer = RunWriter.create(folder, head, temperature=True, raw=False)
        self.n_windows = 0

    def windows(self, phases_deg: NDArray[np.float64], **changed: Any) -> None:
        for phase_deg in phases_deg.tolist():
            self.n_windows += 1
            values = {
                "t_s": WINDOW_S * self.n_windows,
                "phase_deg": phase_deg,
                "speed_rad_s": phase_deg / 10.0,
                "frequency_hz": 41_000.0,
                "torque_nm": 0.0,
                "angle_rad": 0.0,
                "window_s": WINDOW_S,
                "sweep": 0,
                "settled": 1,
                "average_rad_s": phase_deg / 10.0,
                "drive_on": 1,
                "temperature_c": 25.0,
            }
            self.writer.window(WindowRow(**(values | changed)))

    def pair(self, phase_deg: float, direction: int = 1, **changed: Any) -> None:
        values = {
            "phase_deg": phase_deg,
            "frequency_hz": 41_000.0,
            "torque_nm": 0.0,
            "speed_rad_s": phase_deg / 10.0,
            "speed_std_rad_s": 0.05,
            "n_windows": 10,
            "direction": direction,
            "t_s": WINDOW_S * self.n_windows,
            "dwell": 0,
            "settled": 1,
        }
        self.writer.pair(PairRow(**(values | changed)))


MakeRun = Callable[..., GrowingRun]


@pytest.fixture
def make_run(tmp_path: Path) -> Iterator[MakeRun]:
    runs: list[GrowingRun] = []

    def make(**meta: Any) -> GrowingRun:
        runs.append(GrowingRun(tmp_path / f"run{len(runs)}", **meta))
        return runs[-1]

    yield make
    for run in runs:
        run.writer.close("interrupted")


@pytest.fixture
def line_model() -> HammersteinModel:
    """A motor at a tenth of the phase, which follows at once."""
    knots_deg = np.array([-90.0, 90.0])
    curve = StaticCurve(knots_deg, knots_deg / 10.0)
    point = OperatingPoint(41_000.0, 0.0, curve, (-90.0, 90.0), (None, None), 0.1)
    return HammersteinModel(LinearPart(np.array([0.0]), np.array([1.0]), 0, 0.01), (point,), "fast")
