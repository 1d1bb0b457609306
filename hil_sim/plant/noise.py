"""Coloured torque noise, addressed by the number of the time step."""

import math
from itertools import accumulate, islice

import numpy as np

BLOCK = 2048
"""Steps in a block of noise."""


class TorqueNoise:
    """First-order coloured Gaussian noise, the same at a step whatever was asked before.

    Parameters
    ----------
    seed
        Seed of the plant.
    noise_nm
        Standard deviation.
    correlation_s
        Correlation time, short against a block.
    step_s
        Length of a step.
    """

    def __init__(self, seed: int, noise_nm: float, correlation_s: float, step_s: float):
        self._seed = seed
        self._decay = math.exp(-step_s / correlation_s)
        self._gain_nm = noise_nm * math.sqrt(1.0 - self._decay**2)

    def block(self, number: int) -> list[float]:
        """Return the noise of steps `number`·BLOCK and the BLOCK − 1 after it.

        Parameters
        ----------
        number
            Number of the block, from 0.

        Returns
        -------
        list of float
            Torque in N·m at each step.
        """
        # The block before fills the filter's memory, which is short against a block.
        white = np.concatenate([self._white(number), self._white(number + 1)])
        shocks_nm, decay = (self._gain_nm * white).tolist(), self._decay
        # To import scipy.signal takes longer than to filter minutes this way.
        coloured_nm = accumulate(shocks_nm, lambda last_nm, shock_nm: decay * last_nm + shock_nm)
        return list(islice(coloured_nm, BLOCK, None))

    def _white(self, number: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """Block of white noise that depends on nothing but the seed and its number."""
        return np.random.default_rng([self._seed, number]).standard_normal(BLOCK)
