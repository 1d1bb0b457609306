"""A cause of another size in each run is told of."""

import numpy as np
import pytest

from known_motor import applied, driven, problem_of
from usmbench.diagnose.fitting.fit import Fit
from usmbench.diagnose.fitting.refining import refine_widely
from usmbench.diagnose.naming.run_to_run import sizes_by_run
from usmbench.diagnose.residual.problem import Problem
from usmbench.runs.record import Record


def scaled(records: list[Record]) -> tuple[Problem, Fit]:
    """Return runs to be judged, and the one scale of the phase that suits all of them."""
    problem = problem_of(records)
    return problem, refine_widely(
        problem, Fit((applied("phase_scale", "", scale_error=0.01),), 0.0, 0.0)
    )


@pytest.mark.parametrize(("errors", "told"), [((0.02, 0.02), False), ((0.01, 0.03), True)])
def test_a_size_that_differs_from_run_to_run_is_told_by_run(
    errors: tuple[float, float], told: bool
) -> None:
    records = []
    for k, error in enumerate(errors):
        phase_deg = np.repeat(np.random.default_rng(k).uniform(-88.0, 88.0, 120), 5)
        records.append(driven(phase_deg, 50 + k, applied("phase_scale", "", scale_error=error)))
    says = sizes_by_run(*scaled(records), 1.0)
    assert bool(says) == told
    for record, error in zip(records, errors, strict=True) if told else ():
        (of_run,) = (part for part in says[0].split(", ") if f"in {record.name}" in part)
        assert float(of_run.split(" in ")[0].split()[-1]) == pytest.approx(error, abs=2e-3)


def test_one_run_differs_from_no_other() -> None:
    phase_deg = np.repeat(np.random.default_rng(0).uniform(-88.0, 88.0, 120), 5)
    record = driven(phase_deg, 50, applied("phase_scale", "", scale_error=0.02))
    assert sizes_by_run(*scaled([record]), 1.0) == []
