"""What is whitened has the covariance that the noise says."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import toeplitz

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.colour import autocovariance
from usmbench.diagnose.noise.noise_estimate import estimate_noise
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.diagnose.noise.whitening import memory_rows, whitening

Array = NDArray[np.float64]

FEEDBACK, INNOVATION = 0.7, np.sqrt(1.0 - 0.7**2)


@pytest.fixture
def noise(stretches: list[Stretch]) -> Noise:
    """Return a coloured noise, with jitter four times as large after steps."""
    rough = estimate_noise(
        stretches, [s.residual_rad_s for s in stretches], [s.use for s in stretches]
    )
    sigma = np.full_like(rough.sigma_rad_s, 0.02)
    spread = np.zeros_like(rough.step_spread_rad_s)
    spread[0] = 0.08
    return replace(
        rough,
        sigma_rad_s=sigma,
        step_spread_rad_s=spread,
        start_rad_s=np.zeros_like(rough.start_rad_s),
        same_again=np.zeros_like(rough.same_again),
        ar=np.array([FEEDBACK]),
        innovation=INNOVATION,
    )


def _covariance(noise: Noise, stretch: Stretch) -> Array:
    level, calm = noise.level_rad_s(stretch), noise.calm_rad_s(stretch)
    colour = toeplitz(FEEDBACK ** np.arange(level.size))
    covariance: Array = np.outer(calm, calm) * colour + np.diag(level**2 - calm**2)
    return covariance


def test_jitter_is_as_white_as_the_rest_is_coloured(stretches: list[Stretch], noise: Noise) -> None:
    (stretch,) = stretches
    level = noise.level_rad_s(stretch)
    assert np.max(level) > 3.0 * np.min(level)
    white = whitening(noise, stretch).toarray()
    left = white @ _covariance(noise, stretch) @ white.T
    np.testing.assert_allclose(left, np.eye(level.size), atol=0.02)


def test_a_noise_without_colour_looks_back_at_no_row(
    stretches: list[Stretch], noise: Noise
) -> None:
    (stretch,) = stretches
    plain = replace(noise, ar=np.empty(0), innovation=1.0)
    assert memory_rows(plain) == 0
    expected = np.diag(1.0 / plain.level_rad_s(stretch))
    np.testing.assert_allclose(whitening(plain, stretch).toarray(), expected, rtol=1e-12)


def test_the_colour_is_found_beside_the_jitter(stretches: list[Stretch], noise: Noise) -> None:
    (stretch,) = stretches
    rng = np.random.default_rng(5)
    root = np.linalg.cholesky(_covariance(noise, stretch))
    drawn = [root @ rng.standard_normal(root.shape[0]) for _ in range(40)]
    found = estimate_noise(stretches * 40, drawn, [stretch.use] * 40)
    colour = autocovariance(found.ar, found.innovation, 3)
    np.testing.assert_allclose(colour / colour[0], FEEDBACK ** np.arange(4), atol=0.05)
