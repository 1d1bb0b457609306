"""Two causes weighed given each other."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import WINDOW_S, applied, driven, identified
from usmbench.diagnose.naming.ranking import rank
from usmbench.diagnose.naming.stepwise import name_causes
from usmbench.diagnose.pipeline import searched
from usmbench.diagnose.residual.own_effects import cut_beside_own
from usmbench.model.effects.registry import library


@pytest.mark.parametrize("seed", range(2))
def test_what_follows_the_first_explains_more_beside_what_is_nearly_as_good(seed: int) -> None:
    """A weight and another scale are much like an asymmetry and an offset at small phases."""
    draw = np.random.default_rng([seed, 23])
    t_s, waves_hz = WINDOW_S * np.arange(2000), (0.1, 0.23, 0.41, 0.77)
    angles = draw.uniform(0.0, 2.0 * np.pi, len(waves_hz))
    waves = [np.sin(2.0 * np.pi * f * t_s + a) for f, a in zip(waves_hz, angles, strict=True)]
    hidden = (
        applied("load_torque", "weight", one_sided_rad_s=-float(draw.uniform(0.08, 0.12))),
        applied("speed_scale", "", scale_error=float(draw.uniform(0.025, 0.035))),
    )
    record = driven(10.0 * np.sum(waves, axis=0), seed, *hidden)
    stretches, _ = cut_beside_own([record], identified())
    problem = searched(stretches, identified()).drop_names().problem
    names = ("load_torque", "speed_scale", "gain_asymmetry", "phase_offset")
    effects = [e for e in library() if not e.sporadic and e.name in names]
    ranked = rank(problem, effects, 1.0)
    best, lean = (
        next(r for r in ranked if r.effect.name == n) for n in ("load_torque", "gain_asymmetry")
    )
    lean = replace(lean, score=best.score + 1.0, statistic=best.statistic)
    named = name_causes(problem, [lean, *(r for r in ranked if r != lean)], effects, 1.0)
    assert {r[0].effect.name for r in named.rankings} == {"load_torque", "speed_scale"}
