"""What runs teach: what they share, and what each is off by on its own."""

from dataclasses import replace

import numpy as np
import pytest

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.known.learning import Learnt, learn
from usmbench.diagnose.noise.noise_estimate import estimate_noise

NOISE_RAD_S = 0.01
GAIN = 0.02


def _learnt(stretch: Stretch, off: list[float], far_rad_s: float = 0.0) -> tuple[Learnt, float]:
    """Return what runs teach that share a shape, with gains of their own, and how far it is off.

    Three windows of the first are far out.
    """
    rng = np.random.default_rng(2)
    features = features_of([stretch])
    shape = np.column_stack(list(features.columns(stretch)))
    shared_rad_s = shape @ (features.prior * rng.standard_normal(features.prior.size))
    own = GAIN * stretch.simulated_rad_s[:, None]
    runs = [
        replace(
            stretch,
            run=k,
            speed_rad_s=stretch.simulated_rad_s
            + shared_rad_s
            + own @ [share]
            + NOISE_RAD_S * rng.standard_normal(stretch.context.n),
        )
        for k, share in enumerate(off)
    ]
    runs[0].speed_rad_s[[20, 90, 150]] += far_rad_s
    uses = [s.use for s in runs]
    white = [NOISE_RAD_S * rng.standard_normal(s.context.n) for s in runs]
    noise = estimate_noise(runs, white, uses)
    learnt = learn(features, runs, [shape] * len(runs), noise, uses, [own] * len(runs))
    left_rad_s = (shape @ learnt.mean - shared_rad_s)[stretch.use]
    return learnt, float(np.sqrt(np.mean(left_rad_s**2)))


def test_what_runs_share_is_the_models_and_what_sets_them_apart_their_own(
    stretches: list[Stretch],
) -> None:
    off = [1.0, -0.6, 0.8, -1.2]
    learnt, off_rad_s = _learnt(stretches[0], off)
    assert learnt.runs[:, 0] == pytest.approx(off, abs=0.1)
    assert float(np.sum(learnt.runs)) == pytest.approx(0.0, abs=1e-3)
    assert off_rad_s < NOISE_RAD_S
    # The equations of what is their own lead to the same.
    gram = learnt.gram.reshape(4, 4) + np.eye(4)
    assert np.linalg.solve(gram, learnt.slope.ravel()) == pytest.approx(off, abs=0.15)


def test_a_run_that_hardly_shows_a_departure_does_not_make_up_for_the_others(
    stretches: list[Stretch],
) -> None:
    """What three runs show alike is the model's, though a fourth could take the opposite."""
    whole = stretches[0]
    features = features_of([whole])
    shape = np.column_stack(list(features.columns(whole)))
    rng = np.random.default_rng(7)
    alike = GAIN * whole.simulated_rad_s
    runs = [replace(whole, run=k, speed_rad_s=whole.simulated_rad_s + alike) for k in range(4)]
    for run in runs:
        run.speed_rad_s[:] += NOISE_RAD_S * rng.standard_normal(whole.context.n)
    uses = [s.use for s in runs]
    uses[3] = uses[3] & (np.arange(whole.context.n) < np.flatnonzero(uses[3])[3])
    white = [NOISE_RAD_S * rng.standard_normal(s.context.n) for s in runs]
    noise = estimate_noise(runs, white, [s.use for s in runs])
    own = [alike[:, None]] * 4
    learnt = learn(features, runs, [shape] * 4, noise, uses, own)
    assert np.max(np.abs(learnt.runs[:3, 0])) < 0.1


def test_one_run_alone_teaches_what_it_shows(stretches: list[Stretch]) -> None:
    learnt, off_rad_s = _learnt(stretches[0], [0.0])
    assert learnt.runs.shape == (1, 1)
    assert off_rad_s < NOISE_RAD_S


def test_windows_that_are_far_out_teach_little(stretches: list[Stretch]) -> None:
    learnt, off_rad_s = _learnt(stretches[0], [0.5, -0.5], far_rad_s=3.0)
    assert learnt.runs[:, 0] == pytest.approx([0.5, -0.5], abs=0.1)
    assert off_rad_s < 3.0 * NOISE_RAD_S
