"""Steps of which a model only guesses how large they are."""

from dataclasses import replace

import numpy as np

from known_motor import CURVE, driven, identified
from usmbench.diagnose.cutting.cut_runs import cut_runs
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.features_of_runs import features_of
from usmbench.diagnose.known.guessed_steps import following_guesses


def _stretch(*phases_deg: float) -> Stretch:
    phase_deg = np.r_[np.full(60, phases_deg[0]), np.repeat(phases_deg[1:], 10)]
    (stretch,), _ = cut_runs([driven(phase_deg, 3)], identified(), ())
    return stretch


def _after_steps(known_at_deg: list[float], off: str, *phases_deg: float) -> np.ndarray:
    """Scatter in the first window of each dwell, where a shape is known to be off by its prior."""
    features = features_of([_stretch(*known_at_deg * 20)])
    mean = np.where(np.array(features.groups) == off, features.prior, 0.0)
    (marked,) = following_guesses([_stretch(*phases_deg)], features, mean)
    scatter = np.broadcast_to(marked.scatter_rad_s, (marked.context.n,))
    assert np.all(scatter[marked.lag > 6] == 0.0)
    return np.asarray(scatter[60::10])


EVERY_20_DEG = list(np.arange(-80.0, 81.0, 20.0))


def test_a_step_between_phases_that_were_driven_is_none() -> None:
    steps = _after_steps(EVERY_20_DEG, "braking", 80.0, 20.0, 60.0, -40.0, 40.0, 80.0, 20.0)
    assert np.max(steps) < 1e-3


def test_a_step_to_a_guessed_speed_scatters_where_steps_are_followed_otherwise() -> None:
    to_guess = _after_steps(EVERY_20_DEG, "braking", 80.0, 30.0, 80.0, 40.0, 60.0, 60.1)
    assert np.all(to_guess[:2] > 0.003 * np.ptp(CURVE.delta) / 20.0)
    assert np.max(to_guess[2:]) < 0.1 * np.min(to_guess[:2])
    assert np.max(_after_steps(EVERY_20_DEG, "heat", 80.0, 30.0, 80.0, 20.0, 80.0, 60.0)) == 0.0


def test_a_glide_through_guessed_speeds_is_no_step() -> None:
    glides = _after_steps(EVERY_20_DEG, "braking", 80.0, 30.0, 30.02, 30.04, 30.06, 30.08)
    assert np.max(glides[1:]) < 0.05 * glides[0]


def test_of_phases_driven_at_every_degree_next_to_nothing_is_a_guess() -> None:
    every_deg = list(np.arange(-88.0, 89.0))
    assert np.max(_after_steps(every_deg, "braking", 80.0, 30.0, -40.0, 5.0, 60.0)) < 1e-3


def test_a_model_file_that_says_nothing_of_guesses_has_none() -> None:
    stretch = _stretch(*EVERY_20_DEG)
    said = features_of([stretch])
    for features in (replace(said, unmeasured_rad_s=()), replace(said, between_rad_s=())):
        assert following_guesses([stretch], features, features.prior) == [stretch]
