"""How far windows are from those beside them, by what else they may be off by."""

from dataclasses import replace

import numpy as np
import pytest

from known_motor import CURVE, NOISE_RAD_S, driven, identified
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.naming.apart_windows import away_rad_s, scatter_rad_s
from usmbench.diagnose.naming.sporadic import find_sporadic
from usmbench.diagnose.residual.problem import Problem


def test_what_follows_small_steps_tells_nothing_of_what_follows_large_ones() -> None:
    """Runs that tell of small steps only leave it open how the motor follows large ones."""
    model, rng = identified(), np.random.default_rng(2)
    levels_deg = np.where(np.arange(600) % 60, 60.0 + rng.uniform(-3.0, 3.0, 600), 25.0)
    phase_deg = np.repeat(levels_deg, 20)
    record = driven(phase_deg, 4)
    steps_rad_s = np.diff(CURVE.speed_rad_s(levels_deg), prepend=CURVE.speed_rad_s(levels_deg[:1]))
    off = np.zeros(phase_deg.size)
    off[3::20] = 0.1 * steps_rad_s * rng.normal(size=600) * (np.abs(steps_rad_s) > 2.0)
    assert np.count_nonzero(np.abs(off) > 10.0 * NOISE_RAD_S) > 5
    (stretch,), _ = cut_runs([replace(record, speed_rad_s=record.speed_rad_s + off)], model, ())
    known = knowledge_of(model)
    noise = known.noise
    assert noise is not None
    lag = np.array([g in ("lag 3", "lag 4", "lag 5") for g in known.features.groups])
    known = replace(known, root=known.root + np.diag(0.1 * lag))
    problem = Problem([stretch], known, noise, [stretch.use])
    assert find_sporadic(problem, (), 1.0) is None


def test_windows_at_like_phases_say_how_much_a_noise_scatters_there() -> None:
    rng = np.random.default_rng(5)
    record = driven(rng.uniform(-88.0, 88.0, 6000), 5)
    (stretch,), _ = cut_runs([record], identified(), ())
    phase_deg = stretch.context.phase_deg
    quiet, loud = (away_rad_s(level * rng.standard_normal(phase_deg.size)) for level in (0.1, 0.5))
    (found,) = scatter_rad_s([stretch], [np.where(phase_deg > 0.0, loud, quiet)])
    assert np.median(found[phase_deg < -2.0]) == pytest.approx(0.1, rel=0.05)
    assert np.median(found[phase_deg > 2.0]) == pytest.approx(0.5, rel=0.05)
