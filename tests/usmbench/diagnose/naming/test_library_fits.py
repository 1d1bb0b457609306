"""The library fitted: what shows little at first is not left so small."""

import numpy as np
import pytest

from known_motor import UP_AND_DOWN_DEG, applied, driven, identified
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.library_fits import fit_library
from usmbench.diagnose.residual.problem import Problem
from usmbench.model.effects.registry import library


@pytest.mark.parametrize(("lost_rad_s", "fades_rad_s"), [(6.0, 2.6), (3.0, 5.0)])
def test_what_shows_little_at_first_is_tried_larger(lost_rad_s: float, fades_rad_s: float) -> None:
    """Friction that holds the rotor at half of its speed: its slope at none is hardly any."""
    slips = applied("stick_slip", "", lost_rad_s=lost_rad_s, fades_rad_s=fades_rad_s)
    (stretch,), _ = cut_runs([driven(np.repeat(UP_AND_DOWN_DEG, 10), 3, slips)], identified(), ())
    known = knowledge_of(identified())
    assert known.noise is not None
    problem = Problem([stretch], known, known.noise, [stretch.use])
    testable = [e for e in library() if e.untestable([stretch.context]) is None and not e.sporadic]
    best = max(fit_library(problem, testable, lambda _: False), key=lambda fit: fit.statistic)
    assert [a.effect.name for a in best.effects] == ["stick_slip"]
    assert best.statistic > 0.99 * problem.deviance
