"""The whitened problem: how far a simulation is from the measurement, given all that is known.

The residual's covariance is ``C = noise + Σ τ² u uᵀ``, where each column u is something that may
differ without being news: the curve's own error, the steps' mean jitter, gain and dead zone of the
run. With the noise whitened to 1, ``eᵀ C⁻¹ e = min_β |e − Uβ|² + |β|²`` (U with its deviations τ
in it), so a residual is carried as the vector ``[e − Uβ̂; β̂]``: its square is the deviance. U is
kept as shapes, mostly zeros, and the ways in which they may differ together, which are not.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.sparse import csr_array

from usmbench.diagnose.free_runs import FreeRuns
from usmbench.diagnose.knowledge import Knowledge
from usmbench.diagnose.noise import Noise
from usmbench.diagnose.stretches import Mask, Stretch
from usmbench.model.extended import Applied

Array = NDArray[np.float64]

_HIDDEN = 0.05  # share of the noise's variance below which a shape's own does not count


class Problem:
    """Stretches, their noise and what is known, ready to weigh residuals.

    Parameters
    ----------
    stretches
        The runs.
    known
        What is known beforehand.
    noise
        The noise in force.
    masks
        Rows of each stretch that count.
    own
        The model's own effects.
    weights
        Factor on each whitened row of each stretch; None for 1.
    """

    def __init__(
        self,
        stretches: Sequence[Stretch],
        known: Knowledge,
        noise: Noise,
        masks: Sequence[Mask],
        own: Sequence[Applied] = (),
        weights: Sequence[Array] | None = None,
    ):
        self.stretches = tuple(stretches)
        self.known, self.noise = known, noise
        self.own = tuple(own)
        self._runs = FreeRuns(self.stretches)
        self._weights = (
            tuple(np.ones(s.context.n) for s in self.stretches)
            if weights is None
            else tuple(weights)
        )
        self._filter = np.r_[1.0, -noise.ar] / noise.innovation
        self._level = [noise.level_rad_s(s) for s in self.stretches]
        expected = [known.expected_rad_s(s) for s in self.stretches]
        self.residual_rad_s = [
            s.residual_rad_s - e for s, e in zip(self.stretches, expected, strict=True)
        ]
        shapes, self._root = known.background(self.stretches)
        self._shapes = csr_array(np.concatenate(self._white(shapes)))
        self._judge(masks)

    @property
    def n_rows(self) -> int:
        """Rows that count."""
        return sum(int(np.count_nonzero(valid)) for valid in self._valid)

    @property
    def valid(self) -> tuple[Mask, ...]:
        """Rows of each stretch that count, and whose past counts."""
        return tuple(self._valid)

    def with_masks(self, masks: Sequence[Mask]) -> "Problem":
        """Return the same problem on other rows.

        Parameters
        ----------
        masks
            Rows of each stretch that count.
        """
        other = copy(self)
        other._judge(masks)
        return other

    def change_rad_s(self, effects: Sequence[Applied]) -> list[Array]:
        """Return what effects change in the free run, by stretch.

        Parameters
        ----------
        effects
            The effects, beyond the model's own.
        """
        extended = self._runs.speed_rad_s((*self.own, *effects))
        return [e - s.simulated_rad_s for e, s in zip(extended, self.stretches, strict=True)]

    def left_rad_s(self, effects: Sequence[Applied]) -> list[Array]:
        """Return the residual of each stretch with effects taken out, in rad/s, shape (N,).

        Parameters
        ----------
        effects
            The effects, beyond the model's own; none leaves the residual as it is.
        """
        if not effects:
            return self.residual_rad_s
        changes = self.change_rad_s(effects)
        return [r - c for r, c in zip(self.residual_rad_s, changes, strict=True)]

    def left(self, effects: Sequence[Applied]) -> Array:
        """Return the carried residual with effects taken out, shape (M,).

        Parameters
        ----------
        effects
            The effects, beyond the model's own; none leaves the residual as it is.
        """
        return self.carried(self.left_rad_s(effects)) if effects else self.residual

    def carried(self, signal: Sequence[Array]) -> Array:
        """Return a residual as the vector whose square is its deviance, shape (M,) or (M, K).

        Parameters
        ----------
        signal
            The residual of each stretch, in rad/s, shape (N,), or (N, K) for K of them at once.
        """
        white = self._rows(self._white(signal))
        shaped = np.asarray(self._judged.T @ white)
        beta = ((self._ways.T @ shaped).T / self._tension).T
        carried: Array = np.concatenate([white - self._judged @ (self._ways @ beta), beta])
        return carried

    def _judge(self, masks: Sequence[Mask]) -> None:
        """Take the rows that count, and on them what is no news, as far as it exceeds the noise."""
        self.masks = tuple(masks)
        self._valid = [self._whole(mask) for mask in self.masks]
        self._judged = self._shapes[np.concatenate(self._valid)]
        alike = (self._judged.T @ self._judged).toarray()
        power, ways = np.linalg.eigh(self._root.T @ alike @ self._root)
        shown = power > _HIDDEN
        self._ways: Array = self._root @ ways[:, shown]
        self._tension: Array = 1.0 + power[shown]  # UᵀU + 1, which is diagonal
        self.residual = self.carried(self.residual_rad_s)
        self.deviance = float(self.residual @ self.residual)

    def _white(self, signal: Sequence[Array]) -> list[Array]:
        """Whiten each stretch, shape (N,) or (N, K)."""
        parts = []
        for values, level, weight in zip(signal, self._level, self._weights, strict=True):
            white = lfilter(self._filter, [1.0], (values.T / level).T, axis=0)
            parts.append((white.T * weight).T)
        return parts

    def _rows(self, white: Sequence[Array]) -> Array:
        """Keep the rows that count."""
        return np.concatenate([w[valid] for w, valid in zip(white, self._valid, strict=True)])

    def _whole(self, mask: Mask) -> Mask:
        """Rows that count, and whose predecessors in the noise's memory count."""
        whole = mask.copy()
        for k in range(1, self.noise.ar.size + 1):
            whole[k:] &= mask[:-k]
            whole[:k] = False
        return whole


@dataclass(frozen=True, slots=True)
class Basis:
    """An orthonormal basis of carried columns.

    Parameters
    ----------
    vectors
        Shape (M, rank).
    """

    vectors: Array

    def square(self, carried: Array) -> float:
        """Return the square of a carried residual's projection.

        Parameters
        ----------
        carried
            Shape (M,).
        """
        part = self.vectors.T @ carried
        return float(part @ part)
