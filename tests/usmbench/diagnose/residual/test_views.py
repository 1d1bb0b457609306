"""The bands of the views hold what noise leaves, whatever its colour."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.residual.views import residual_views
from usmbench.model.hammerstein import HammersteinModel


@pytest.mark.parametrize("feedback", [0.0, 0.9])
def test_noise_keeps_within_the_band_in_19_of_20_runs(
    model: HammersteinModel, stretches: list[Stretch], feedback: float
) -> None:
    (stretch,) = stretches
    known = replace(knowledge_of(model), root=np.zeros_like(knowledge_of(model).root))
    rough = estimate_noise(stretches, [stretch.residual_rad_s], [stretch.use])
    innovation = np.sqrt(1.0 - feedback**2)
    noise = replace(
        rough,
        sigma_rad_s=np.full_like(rough.sigma_rad_s, 0.5),
        ar=np.array([feedback]) if feedback else np.empty(0),
        innovation=innovation,
        step_spread_rad_s=np.zeros_like(rough.step_spread_rad_s),
        start_rad_s=np.zeros_like(rough.start_rad_s),
    )
    problem, rng = Problem(stretches, known, noise, [stretch.use]), np.random.default_rng(2)
    n, outside, seen = stretch.context.n, 0, 0
    calm = noise.calm_rad_s(stretch)
    jitter = np.sqrt(noise.level_rad_s(stretch) ** 2 - calm**2)
    for _ in range(100):
        white = rng.standard_normal(n + 200)
        coloured = lfilter([innovation], [1.0, -feedback], white)[200:]
        left = calm * coloured + jitter * rng.standard_normal(n)
        views = residual_views(problem.measuring([left]), [left], 1.0)
        outside += sum(view.excess_before > 1.0 for view in views)
        seen += len(views)
    assert 0.02 < outside / seen < 0.09


def test_a_noise_of_hardly_any_variance_ties_no_rows(
    model: HammersteinModel, stretches: list[Stretch]
) -> None:
    """A file mended by hand may say so."""
    rough = estimate_noise(stretches, [s.residual_rad_s for s in stretches], _use(stretches))
    noise = replace(rough, ar=np.empty(0), innovation=0.05)
    problem = Problem(stretches, knowledge_of(model), noise, _use(stretches))
    views = residual_views(problem, problem.residual_rad_s, 1.0)
    assert all(np.all(view.band_rad_s > 0.0) for view in views)


def _use(stretches: list[Stretch]) -> list[Mask]:
    return [s.use for s in stretches]
