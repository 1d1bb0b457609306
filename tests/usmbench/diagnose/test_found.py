"""Whether what is named may stand beside what it leaves."""

import numpy as np
import pytest

from known_motor import NOISE_RAD_S, driven, identified
from usmbench.diagnose.cut_runs import cut_runs
from usmbench.diagnose.fitting import Fit
from usmbench.diagnose.found import Found
from usmbench.diagnose.knowledge import knowledge_of
from usmbench.diagnose.naming import Whole
from usmbench.diagnose.problem import Problem


@pytest.mark.parametrize(("spread", "mostly_left"), [(1.2, False), (1.8, True)])
def test_a_noise_that_has_grown_to_a_finding_is_left_by_a_name(
    spread: float, mostly_left: bool
) -> None:
    model = identified()
    record = driven(np.repeat(np.random.default_rng(6).uniform(-88.0, 88.0, 100), 20), 6)
    more = np.sqrt(spread**2 - 1.0) * NOISE_RAD_S * np.random.default_rng(7).standard_normal(2000)
    record.speed_rad_s[:] += more
    (stretch,), _ = cut_runs([record], model, ())
    known = knowledge_of(model)
    assert known.noise is not None
    problem = Problem([stretch], known, known.noise, [stretch.use])
    fit = Fit((), 0.1 * problem.deviance, 0.0)
    quiet = Whole(0.0, 1.0, problem.n_rows)
    assert Found(problem, spread, [], [], fit, quiet, quiet).mostly_left == mostly_left
