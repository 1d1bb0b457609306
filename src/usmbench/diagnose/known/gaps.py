"""Gaps between measured phases, and how far off a curve may be there."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from usmbench.identify.like_phases import SAME_PHASE, distinct_deg
from usmbench.model.effects.later_start import STANDING

Array = NDArray[np.float64]

KINK = 0.25
"""A slope that turns by s within h leaves a straight line across by up to s h / 4."""
_START = 0.5 / KINK  # of its slope: a gap's middle is then off by half of the step across it


@dataclass(frozen=True, slots=True)
class Gaps:
    """Measured phases, and by how much a slope may turn between two of them.

    Over a gap in which the slope turns, a curve may turn anywhere.

    Parameters
    ----------
    measured_deg
        Phases that were measured, rising, shape (M,).
    turn
        Most that the slope may turn by between one and the next, in rad/s a degree, shape (M − 1,).
    """

    measured_deg: Array
    turn: Array

    @classmethod
    def of(cls, measured_deg: Array, phase_deg: Array, speeds_rad_s: Sequence[Array]) -> "Gaps":
        """Return the gaps of a drive.

        The slope may turn by as much as that of the model does in a gap, or as the slopes from one
        measured phase to the next do beside it.

        Parameters
        ----------
        measured_deg
            Phases that were measured, rising, shape (M,).
        phase_deg
            Phases, evenly spaced and rising, shape (N,).
        speeds_rad_s
            Settled speeds of the model there at each operating point, shape (N,) each.
        """
        # Two that are one but for rounding would make slopes of nothing.
        measured_deg = distinct_deg(measured_deg)
        if measured_deg.size < 2:
            return cls(phase_deg[[0, -1]], np.zeros(1))
        turn = np.zeros(measured_deg.size - 1)
        for speed_rad_s in speeds_rad_s:
            inside = _inside(np.gradient(speed_rad_s, phase_deg), phase_deg, measured_deg)
            beside = _beside(np.interp(measured_deg, phase_deg, speed_rad_s), measured_deg)
            turn = np.maximum(turn, np.maximum(inside, beside))
        return cls(measured_deg, turn)

    def at_nodes_rad_s(self, nodes_deg: Array) -> Array:
        """Return how far off a curve may be at nodes for lying between measured phases.

        Parameters
        ----------
        nodes_deg
            The nodes, rising, shape (K,).

        Returns
        -------
        Array
            Shape (K,).
        """
        gap, apart_deg = self._holding(nodes_deg)
        return np.where(apart_deg > self._same_deg, self._across_rad_s(gap, np.inf), 0.0)

    def between_nodes_rad_s(self, nodes_deg: Array) -> Array:
        """Return how far off a straight line between two nodes may be within one gap.

        Parameters
        ----------
        nodes_deg
            The nodes, rising, shape (K,).

        Returns
        -------
        Array
            Shape (K − 1,).
        """
        width_deg = np.diff(nodes_deg)
        gap, apart_deg = self._holding(0.5 * (nodes_deg[1:] + nodes_deg[:-1]))
        within = apart_deg > 0.5 * width_deg - self._same_deg
        return np.where(within, self._across_rad_s(gap, width_deg), 0.0)

    @property
    def _same_deg(self) -> float:
        """How near a node lies at a measured phase."""
        return SAME_PHASE * float(np.ptp(self.measured_deg))

    def _holding(self, at_deg: Array) -> tuple[NDArray[np.intp], Array]:
        """Gap that phases lie in, and how far they are from its nearer end."""
        right = np.clip(np.searchsorted(self.measured_deg, at_deg), 1, self.turn.size)
        low_deg, high_deg = self.measured_deg[right - 1], self.measured_deg[right]
        return right - 1, np.minimum(at_deg - low_deg, high_deg - at_deg)

    def _across_rad_s(self, gap: NDArray[np.intp], most_deg: Array | float) -> Array:
        """How far off a straight line may be across gaps, or parts of them."""
        width_deg = np.minimum(np.diff(self.measured_deg)[gap], most_deg)
        return np.asarray(KINK * self.turn[gap] * width_deg)


def _inside(slope: Array, phase_deg: Array, measured_deg: Array) -> Array:
    """By how much a slope turns in each gap, shape (M − 1,)."""
    low = np.searchsorted(phase_deg, measured_deg[:-1])
    high = np.searchsorted(phase_deg, measured_deg[1:], side="right")
    turned = np.zeros(low.size)
    for k in np.flatnonzero(high > low + 1):
        turned[k] = np.ptp(slope[low[k] : high[k]])
    return turned


def _beside(at_rad_s: Array, measured_deg: Array) -> Array:
    """By how much slopes turn from the gap before each to the gap after, shape (M − 1,).

    Where in a gap a dead zone ends, or a speed saturates, the model cannot know; between two phases
    at which the rotor stands, it stands. Where it stands at one of them, it may stand almost to the
    other: two standard deviations are the whole way from the one speed to the other.
    """
    slopes = np.diff(at_rad_s) / np.diff(measured_deg)
    stands = np.abs(at_rad_s) < STANDING * np.max(np.abs(at_rad_s), initial=0.0)
    turned = np.ptp(sliding_window_view(np.pad(slopes, 1, mode="edge"), 3), axis=1)
    anywhere = np.maximum(turned, _START * np.abs(slopes))
    return np.select([stands[1:] & stands[:-1], stands[1:] | stands[:-1]], [0.0, anywhere], turned)
