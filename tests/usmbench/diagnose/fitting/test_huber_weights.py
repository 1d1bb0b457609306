"""Which rows tell the noise of a run."""

import numpy as np
import pytest

from known_motor import driven, identified
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.fitting.huber_weights import huber_weights, robust_spread
from usmbench.diagnose.known.model_knowledge import knowledge_of
from usmbench.diagnose.noise.rotor_states import turns
from usmbench.diagnose.residual.problem import Problem


@pytest.mark.parametrize("stands", [0.2, 0.6])
def test_a_rotor_that_stands_without_noise_does_not_hide_that_the_noise_has_grown(
    stands: float,
) -> None:
    model, rng = identified(), np.random.default_rng(3)
    levels_deg = np.where(rng.random(300) < stands, 0.0, rng.uniform(30.0, 85.0, 300))
    stretches, _ = cut_runs([driven(np.repeat(levels_deg, 10), 3)], model, ())
    (stretch,) = stretches
    known = knowledge_of(model)
    assert known.noise is not None
    problem = Problem(stretches, known.nothing, known.noise, [stretch.use])
    grown = 1.5 * turns(stretch) * rng.standard_normal(stretch.context.n)
    left = known.noise.level_rad_s(stretch) * grown
    assert robust_spread(problem, problem.carried([left])) == pytest.approx(1.5, rel=0.1)
    (weights,) = huber_weights(problem, [left])
    # Of normal noise 1.2 % lie beyond 2.5 deviations; by the noise before it grew, 10 % would.
    assert np.mean(weights[turns(stretch)] < 1.0) == pytest.approx(0.012, abs=0.008)
