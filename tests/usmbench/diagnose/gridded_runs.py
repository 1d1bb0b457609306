"""Runs of a generator with a grid of phases, said in run.yaml or not."""

from dataclasses import replace

import numpy as np

from known_motor import applied, driven
from usmbench.runs.record import Record

STEP_DEG = 0.7
GRID = applied("phase_quantisation", "rounded", step_deg=STEP_DEG)


def gridded_run(phases_deg: np.ndarray, seed: int, said_deg: float | None) -> Record:
    """Return a run of a generator with a grid, which its run.yaml may tell of."""
    record = driven(np.repeat(phases_deg, 10), seed, GRID)
    return replace(record, meta={"generator": {"phase_step_deg": said_deg}})
