"""Runs whose encoder's disc lacks marks at some places."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from known_motor import WINDOW_S, driven, problem_of
from usmbench.diagnose.naming.sporadic import Sporadic, find_sporadic
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.applied import Applied
from usmbench.runs.record import Record

Array = NDArray[np.float64]


def gapped_run(seed: int, *gaps_rad: tuple[float, float]) -> Record:
    """Return a run that counts nothing over some part of each revolution: (begin, width) each."""
    phase_deg = np.repeat(np.random.default_rng(seed).uniform(-88.0, 88.0, 120), 20)
    record = driven(phase_deg, 4)
    turned_rad = np.cumsum(np.concatenate([[0.0], record.speed_rad_s])) * WINDOW_S
    seen_rad = turned_rad - sum(_lost_rad(turned_rad, *gap) for gap in gaps_rad)
    return replace(record, speed_rad_s=np.diff(seen_rad) / WINDOW_S)


def _lost_rad(turned_rad: Array, begin_rad: float, width_rad: float) -> Array:
    """Return what was not counted at one gap, at each end of a window."""
    begins_rad = begin_rad + 2.0 * np.pi * np.arange(-40.0, 40.0)
    true_rad = np.sort(np.concatenate([begins_rad, begins_rad + width_rad]))
    missing_rad = np.repeat(width_rad * np.arange(81.0), 2)[1:-1]
    return np.interp(turned_rad, true_rad, missing_rad)


def with_false_counts(record: Record, off_rad_s: float, every: int) -> Record:
    """Return a run in which a window now and then is off, either way."""
    off = np.zeros(record.t_s.size)
    hit = np.arange(7, off.size, every)
    off[hit] = off_rad_s * np.random.default_rng(1).choice([-1.0, 1.0], hit.size)
    return replace(record, speed_rad_s=record.speed_rad_s + off)


def knowing(problem: Problem, *known: Applied) -> Problem:
    """Return a problem whose model has some effects that strike single windows."""
    has = replace(problem.known, sporadic=known)
    return Problem(problem.stretches, has, problem.noise, problem.masks)


def without(problem: Problem, found: Sporadic) -> Problem:
    """Return a problem without the windows that a cause may have struck."""
    pairs = zip(problem.stretches, found.touched, strict=True)
    stretches = [replace(s, use=s.use & ~rows) for s, rows in pairs]
    return Problem(stretches, problem.known, problem.noise, [s.use for s in stretches])


def found_in(record: Record, *known: Applied) -> Sporadic:
    """Return the cause of windows that stand alone in a run."""
    found = find_sporadic(knowing(problem_of([record]), *known), (), 1.0)
    assert found is not None
    return found
