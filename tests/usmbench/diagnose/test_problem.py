"""A residual weighs what its covariance says."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from usmbench.diagnose.knowledge import Knowledge, knowledge_of
from usmbench.diagnose.noise import Noise
from usmbench.diagnose.noise_estimate import estimate_noise
from usmbench.diagnose.problem import Problem
from usmbench.diagnose.stretches import Stretch
from usmbench.model.effects.registry import find_effect
from usmbench.model.extended import Applied
from usmbench.model.hammerstein import HammersteinModel

Array = NDArray[np.float64]

FEEDBACK, INNOVATION = 0.6, 0.8


@pytest.fixture
def known(model: HammersteinModel) -> Knowledge:
    """Return what is known, with ways to differ in which shapes differ together."""
    plain = knowledge_of(model)
    together = np.random.default_rng(3).standard_normal(plain.root.shape)
    return replace(plain, root=plain.root @ together)


@pytest.fixture
def noise(stretches: list[Stretch]) -> Noise:
    """Return a coloured noise."""
    left, uses = [s.residual_rad_s for s in stretches], [s.use for s in stretches]
    rough = estimate_noise(stretches, left, uses)
    return replace(rough, ar=np.array([FEEDBACK]), innovation=INNOVATION)


def innovations(values: Array, level: Array) -> Array:
    """Return what each row but the first adds to what the row before foretells."""
    scaled: Array = (values.T / level).T
    added: Array = (scaled[1:] - FEEDBACK * scaled[:-1]) / INNOVATION
    return added


def test_the_deviance_is_that_of_the_whole_covariance(
    stretches: list[Stretch], known: Knowledge, noise: Noise, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("usmbench.diagnose.problem._HIDDEN", 0.0)
    use = stretches[0].use.copy()
    use[120:123] = False
    problem = Problem(stretches, known, noise, [use])
    counts = use[1:] & use[:-1]
    assert problem.n_rows == np.count_nonzero(counts)
    (shapes,), root = known.background(stretches)
    level = noise.level_rad_s(stretches[0])
    white = innovations(problem.residual_rad_s[0], level)[counts]
    free = innovations(shapes @ root, level)[counts]
    covariance = np.eye(white.size) + free @ free.T
    expected = float(white @ np.linalg.solve(covariance, white))
    assert problem.deviance == pytest.approx(expected, rel=1e-6)
    assert expected < 0.9 * float(white @ white)


def test_several_residuals_weigh_together_what_each_weighs(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    problem = Problem(stretches, known, noise, [s.use for s in stretches])
    signals = np.random.default_rng(1).standard_normal((stretches[0].context.n, 3))
    together = problem.carried([signals])
    for column, signal in zip(together.T, signals.T, strict=True):
        np.testing.assert_allclose(column, problem.carried([signal]), atol=1e-9)


def test_a_weight_is_a_smaller_noise(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    uses = [s.use for s in stretches]
    problem = Problem(stretches, known, noise, uses)
    heavy = problem.weighed(noise, uses, [np.full(s.context.n, 2.0) for s in stretches])
    quiet = problem.weighed(replace(noise, innovation=0.5 * INNOVATION), uses)
    assert heavy.deviance == pytest.approx(quiet.deviance, rel=1e-9)
    assert heavy.deviance > problem.deviance


def test_a_problem_weighed_anew_is_one_made_anew(
    stretches: list[Stretch], known: Knowledge, noise: Noise
) -> None:
    uses = [s.use for s in stretches]
    late = [Applied(find_effect("transport_delay", ""), {"delay_s": 0.004})]
    white = replace(noise, ar=np.empty(0), innovation=1.0)
    problem = Problem(stretches, known, white, uses)
    before = problem.left(late)
    anew = problem.weighed(noise, uses)
    np.testing.assert_array_equal(
        anew.left(late), Problem(stretches, known, noise, uses).left(late)
    )
    np.testing.assert_array_equal(problem.left(late), before)
