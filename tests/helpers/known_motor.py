"""A motor known to the last figure, runs of it with effects in them, and its model."""

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.reference import with_knowledge
from usmbench.diagnose.residual.problem import Problem
from usmbench.identify.fast import FastOptions, identify_fast
from usmbench.model.applied import Applied
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import first_order
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import extended_run
from usmbench.model.hammerstein import HammersteinModel, StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]
WINDOW_S, NOISE_RAD_S = 0.01, 0.02
CURVE = StaticCurve(
    np.array([-90.0, -60, -30, -15, -8, -3, 3, 8, 15, 30, 60, 90]),
    np.array([-10.3, -10.1, -8, 0, 0, 0, 0, 0, 0, 8, 10.2, 10.4]),
)
LINEAR = first_order(0.0035, 0.0015, WINDOW_S)
UP_AND_DOWN_DEG = np.r_[np.arange(-84.0, 85.0, 3.0), np.arange(84.0, -85.0, -3.0)]


def measured(seed: int, *effects: Applied, n: int = 1400) -> Record:
    """Return a run over random phases, five windows each."""
    rng = np.random.default_rng(seed)
    phase_deg = np.repeat(rng.uniform(-88.0, 88.0, n // 5), 5)
    phase_deg[:2], phase_deg[n // 2 : n // 2 + 2] = -89.0, 89.0
    return driven(phase_deg, seed, *effects)


def driven(phase_deg: Array, seed: int, *effects: Applied) -> Record:
    """Return a run over given phases."""
    n = phase_deg.size
    t_s = WINDOW_S * np.arange(1.0, n + 1.0)
    context = Context(t_s, WINDOW_S, phase_deg, CURVE.speed_rad_s, LINEAR)
    speed = extended_run(effects, context).speed_rad_s
    noisy = speed + NOISE_RAD_S * np.random.default_rng([seed, 1]).standard_normal(n)
    return Record(f"run {seed}", t_s, phase_deg, noisy, np.full(n, WINDOW_S))


def applied(name: str, form: str, **values: float) -> Applied:
    """Return a cause of a size."""
    return Applied(find_effect(name, form), values)


def eccentric(seed: int, share: float, phase_rad: float) -> Record:
    """Return a run whose disc is off centre."""
    cosine, sine = share * np.cos(phase_rad), share * np.sin(phase_rad)
    return measured(seed, applied("encoder_eccentricity", "", cosine=cosine, sine=sine))


@cache
def identified() -> HammersteinModel:
    """Return the model that four healthy runs give: two do not tell how far a third may differ."""
    runs = [measured(seed, n=2000) for seed in (1, 2, 101, 102)]
    return with_knowledge(identify_fast(runs, FastOptions(12)).model, runs)


@cache
def wandering() -> HammersteinModel:
    """Return the model of that motor when its gain differs by 1 % from day to day."""
    runs = [
        measured(seed, applied("speed_scale", "", scale_error=error))
        for seed, error in ((1, 0.01), (2, -0.012), (101, 0.006), (102, -0.008))
    ]
    return with_knowledge(identify_fast(runs, FastOptions(12)).model, runs)


def judged(spread: float) -> Problem:
    """Return a healthy run whose noise has grown."""
    record = driven(np.repeat(np.random.default_rng(6).uniform(-88.0, 88.0, 100), 20), 6)
    more = np.sqrt(spread**2 - 1.0) * NOISE_RAD_S * np.random.default_rng(7).standard_normal(2000)
    record.speed_rad_s[:] += more
    return problem_of([record])


def problem_of(records: Sequence[Record]) -> Problem:
    """Return runs, to be judged by the identified model."""
    known, (stretches, _) = knowledge_of(identified()), cut_runs(records, identified(), ())
    assert known.noise is not None
    return Problem(stretches, known, known.noise, [stretch.use for stretch in stretches])
