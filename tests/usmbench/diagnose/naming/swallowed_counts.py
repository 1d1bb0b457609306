"""Runs whose counter swallows lines by chance where the motor is fast."""

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from known_motor import WINDOW_S, driven, identified
from usmbench.diagnose.pipeline import diagnose
from usmbench.diagnose.result import Diagnosis
from usmbench.model.applied import Applied
from usmbench.model.hammerstein import HammersteinModel
from usmbench.runs.record import Record

COUNT_RAD_S = 2.0 * np.pi / 2000.0 / WINDOW_S


def dwelling(*effects: Applied) -> Record:
    """Return a run that stays at each of a hundred phases."""
    phases_deg = np.random.default_rng(3).uniform(-88.0, 88.0, 100)
    return driven(np.repeat(phases_deg, 20), 13, *effects)


def fast_windows(record: Record) -> NDArray[np.bool_]:
    """Windows near the highest speed."""
    size = np.abs(record.speed_rad_s)
    fast: NDArray[np.bool_] = size > 0.95 * np.max(size)
    return fast


def swallowed(record: Record, lines: float, seed: int = 5) -> Record:
    """Return the run with so many of seven lines swallowed in the mean, where it is fast."""
    fast = fast_windows(record)
    counts = 4.0 * np.random.default_rng(seed).binomial(7, lines / 7.0, fast.size) * fast
    return with_counts(record, -np.sign(record.speed_rad_s) * counts)


def with_counts(record: Record, counts: NDArray[np.float64]) -> Record:
    return replace(record, speed_rad_s=record.speed_rad_s + COUNT_RAD_S * counts)


def saying(record: Record, counts_per_rev: int | None) -> Record:
    return replace(record, meta={"encoder": {"counts_per_rev": counts_per_rev}})


@cache
def once_lost(lines: float) -> Diagnosis:
    """Return what is said of a run that so many lines are lost of, of a counter that says so."""
    return diagnose([saying(swallowed(dwelling(), lines), 2000)], identified())


def names_in(record: Record, model: HammersteinModel) -> list[str]:
    return [cause.name for cause in diagnose([record], model).causes]
