"""How far a run may be from what others teach."""

from dataclasses import replace

import numpy as np

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.known.learning import learn
from usmbench.diagnose.known.left_out import covariance_root
from usmbench.diagnose.noise.noise_estimate import estimate_noise

NOISE_RAD_S = 0.01
GAIN = 0.02


def test_what_is_learnt_is_as_unsure_as_runs_left_out_show(stretches: list[Stretch]) -> None:
    whole = stretches[0]
    features = features_of([whole])
    shape = np.column_stack(list(features.columns(whole)))
    variances = []
    for times in (1.0, 2.0):
        rng = np.random.default_rng(11)
        scatter = NOISE_RAD_S * rng.standard_normal((2, whole.context.n))
        runs = [
            replace(whole, run=k, speed_rad_s=whole.simulated_rad_s + times * noisy)
            for k, noisy in enumerate(scatter)
        ]
        uses = [s.use for s in runs]
        noise = estimate_noise(runs, list(scatter), uses)
        own = [GAIN * whole.simulated_rad_s[:, None]] * 2
        learnt = learn(features, runs, [shape] * 2, noise, uses, own)
        root = covariance_root(features, learnt)
        variances.append(np.sum(root**2, axis=1) / features.prior**2)
    # Of shapes that these runs do not show, no scatter tells.
    shown = variances[0] < 0.3
    assert np.count_nonzero(shown) > 10
    assert np.median((variances[1] / variances[0])[shown]) > 2.0
