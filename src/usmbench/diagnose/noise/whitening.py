"""The filter that makes the noise of a stretch white.

The noise is ``e_t = σ_t n_t + j_t``: a coloured part of variance σ² and the jitter of steps and
edges, which has no memory. Each row is compared with what the few rows before it foretell; where
these jitter, they foretell little.
"""

import numpy as np
from scipy.linalg import toeplitz
from scipy.sparse import csr_array, dia_array

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.colour import autocovariance
from usmbench.diagnose.noise.noise_model import Noise

_BEYOND = 2  # rows before those of the colour, for where these jitter


def memory_rows(noise: Noise) -> int:
    """Return how many rows before one foretell its noise.

    Parameters
    ----------
    noise
        The noise.
    """
    return noise.ar.size + _BEYOND if noise.ar.size else 0


def whitening(noise: Noise, stretch: Stretch) -> csr_array[np.float64]:
    """Return the filter that makes the noise of a stretch white, of variance 1, shape (N, N).

    Parameters
    ----------
    noise
        The noise.
    stretch
        The stretch.
    """
    sigma, level = noise.calm_rad_s(stretch), noise.level_rad_s(stretch)
    n, memory = level.size, memory_rows(noise)
    covariance = autocovariance(noise.ar, noise.innovation, memory)
    calm, jitter = sigma / level, 1.0 - (sigma / level) ** 2
    before = np.arange(n)[:, None] - np.arange(1, memory + 1)
    there = before >= 0
    near = np.where(there, calm[before], 0.0)
    alone = np.where(there, jitter[before], 1.0)
    among = near[:, :, None] * near[:, None, :] * toeplitz(covariance[:memory])
    among += alone[:, :, None] * np.eye(memory)
    toward = calm[:, None] * near * covariance[1:]
    foretold = np.linalg.solve(among, toward[:, :, None])[:, :, 0] if memory else toward
    left = calm**2 * covariance[0] + jitter - np.sum(foretold * toward, axis=1)
    taps = np.column_stack((np.ones(n), -foretold)) / np.sqrt(left)[:, None]
    bands = np.array([np.roll(tap, -k) for k, tap in enumerate(taps.T)]) / level
    return csr_array(dia_array((bands, -np.arange(memory + 1)), shape=(n, n)))
