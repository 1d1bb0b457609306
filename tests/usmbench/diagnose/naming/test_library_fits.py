"""The library fitted: what shows little at first is not left so small."""

import numpy as np
import pytest

from known_motor import UP_AND_DOWN_DEG, applied, driven, problem_of
from usmbench.diagnose.naming.library_fits import fit_library
from usmbench.model.effects.registry import library


@pytest.mark.parametrize(("lost_rad_s", "fades_rad_s"), [(6.0, 2.6), (3.0, 5.0)])
def test_what_shows_little_at_first_is_tried_larger(lost_rad_s: float, fades_rad_s: float) -> None:
    """Friction that holds the rotor at half of its speed: its slope at none is hardly any."""
    slips = applied("stick_slip", "", lost_rad_s=lost_rad_s, fades_rad_s=fades_rad_s)
    problem = problem_of([driven(np.repeat(UP_AND_DOWN_DEG, 10), 3, slips)])
    testable = [
        e
        for e in library()
        if e.untestable([s.context for s in problem.stretches]) is None and not e.sporadic
    ]
    best = max(fit_library(problem, testable, lambda _: False), key=lambda fit: fit.statistic)
    assert [a.effect.name for a in best.effects] == ["stick_slip"]
    assert best.statistic > 0.99 * problem.deviance
