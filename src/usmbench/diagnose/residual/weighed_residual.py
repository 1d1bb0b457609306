"""A whitened residual: the rows that count, weighed by the noise and by what is no news."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.diagnose.noise.whitening import memory_rows
from usmbench.diagnose.residual.carrier import Pulled
from usmbench.diagnose.residual.covariance import Covariance

Array = NDArray[np.float64]


class WeighedResidual:
    """Residuals of stretches, and what weighs them.

    Parameters
    ----------
    stretches
        The runs.
    residual_rad_s
        Beyond what it is known to leave, by stretch, shape (N,) each.
    noise
        The noise in force.
    covariance
        By that noise, and by what is no news.
    masks
        Rows of each stretch that count.
    """

    def __init__(
        self,
        stretches: Sequence[Stretch],
        residual_rad_s: Sequence[Array],
        noise: Noise,
        covariance: Covariance,
        masks: Sequence[Mask],
    ):
        self.stretches = tuple(stretches)
        self.residual_rad_s = list(residual_rad_s)
        self.noise = noise
        self._covariance = covariance
        self._judge(masks)

    @property
    def n_rows(self) -> int:
        """Rows that count."""
        return sum(int(np.count_nonzero(valid)) for valid in self._valid)

    @property
    def valid(self) -> tuple[Mask, ...]:
        """Rows of each stretch that count, and whose past counts."""
        return tuple(self._valid)

    def unsure_rad_s(self, rows: Sequence[Mask]) -> list[Array]:
        """Return how far off a residual may be by what is no news, by stretch, shape (N,).

        Parameters
        ----------
        rows
            Rows of each stretch that are asked for; the others get 0.
        """
        return _at(rows, self._covariance.unsure_rad_s)

    def unsure_beside_rad_s(self, rows: Sequence[Mask]) -> list[Array]:
        """Return by how much more than around it a residual may be off, by stretch, shape (N,).

        Parameters
        ----------
        rows
            Rows of each stretch that are asked for; the others get 0.
        """
        return _at(rows, self._covariance.unsure_beside_rad_s)

    def unsure_along(self, signal: Sequence[Array]) -> float:
        """Return the standard deviation of the product of a signal and what is no news.

        Parameters
        ----------
        signal
            By stretch, in rad/s, shape (N,) each.
        """
        return self._covariance.unsure_along(np.concatenate(signal))

    def departed_rad_s(self, signal: Sequence[Array]) -> list[Array]:
        """Return what of a residual most likely is no news, by stretch, shape (N,).

        Parameters
        ----------
        signal
            The residual of each stretch, in rad/s, shape (N,).
        """
        departed = self._carrier.departed(np.concatenate(signal))
        every = self._covariance.shapes.combined(departed)
        return np.split(every, np.cumsum([part.size for part in signal])[:-1])

    def excuses(self) -> tuple[Array, float]:
        """Return how far what is no news has to depart, and what this makes of the noise.

        Returns
        -------
        tuple of Array and float
            As in `Carrier.excuses`.
        """
        return self._carrier.excuses(self.residual)

    def carried(self, signal: Sequence[Array]) -> Array:
        """Return a residual as the vector whose square is its deviance, shape (M,) or (M, K).

        Parameters
        ----------
        signal
            The residual of each stretch, in rad/s, shape (N,), or (N, K) for K of them at once.
        """
        return self._carrier.carried(np.concatenate(signal))

    def square(self, signal: Sequence[Array]) -> float:
        """Return the deviance of a residual.

        Parameters
        ----------
        signal
            The residual of each stretch, in rad/s, shape (N,).
        """
        return self._carrier.square(np.concatenate(signal))

    def pulled(self, signals: Array) -> Pulled:
        """Return residuals by what the products of them, carried, take.

        Parameters
        ----------
        signals
            K residuals, in rad/s, stretch after stretch, shape (N, K).
        """
        return self._carrier.pulled(signals)

    def _judge(self, masks: Sequence[Mask]) -> None:
        """Take the rows that count."""
        self.masks = tuple(masks)
        self._valid = [self._whole(mask) for mask in self.masks]
        self._carrier = self._covariance.carrier(np.concatenate(self._valid))
        self._take_residual()

    def _take_residual(self) -> None:
        """Carry the residual."""
        self.residual = self.carried(self.residual_rad_s)
        self.deviance = self.square(self.residual_rad_s)

    def _whole(self, mask: Mask) -> Mask:
        """Rows that count, and whose predecessors in the noise's memory count."""
        whole = mask.copy()
        for k in range(1, memory_rows(self.noise) + 1):
            whole[k:] &= mask[:-k]
            whole[:k] = False
        return whole


def _at(rows: Sequence[Mask], values: Callable[[Mask], Array]) -> list[Array]:
    """Return values of some rows by stretch, and 0 on the others."""
    asked = np.concatenate(rows)
    every = np.zeros(asked.size)
    every[asked] = values(asked)
    return np.split(every, np.cumsum([mask.size for mask in rows])[:-1])
