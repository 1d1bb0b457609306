"""What a curve does between the few phases that were driven: it goes from one speed to the next.

Samples say nothing there, and a curve that is only smooth may be faster than any speed measured.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from usmbench.identify.like_phases import distinct_deg
from usmbench.model.bernstein import bernstein_basis
from usmbench.model.effects.later_start import STANDING
from usmbench.model.hammerstein import StaticCurve
from usmbench.model.inverse_map import bezier_abscissa

Array = NDArray[np.float64]

_SHARES = np.arange(1, 13) / 13.0  # of a gap
_WEIGHT = 0.02  # of all samples, for each gap: the samples have the say at the levels
_BEYOND = 0.04  # of the highest speed; motors saturate, and smooth curves pass a corner by less


@dataclass(frozen=True, slots=True)
class Levels:
    """The few phases that were driven, and the settled speeds there.

    Parameters
    ----------
    phase_deg
        The phases, rising, shape (M,).
    speed_rad_s
        The speeds, shape (M,).
    """

    phase_deg: Array
    speed_rad_s: Array

    @classmethod
    def of(cls, driven_deg: Array, curve: StaticCurve) -> "Levels":
        """Return the levels of a curve that was fitted to samples.

        Parameters
        ----------
        driven_deg
            Phases of the samples, shape (N,).
        curve
            The curve.
        """
        phase_deg = distinct_deg(driven_deg)
        return cls(phase_deg, curve.speed_rad_s(phase_deg))

    def holds(self, curve: StaticCurve) -> bool:
        """Return whether a curve stays between the speeds at both ends of each gap.

        Where the rotor stands at one of them it turns against its phase otherwise, which no motor
        does.

        Parameters
        ----------
        curve
            The curve.
        """
        low_rad_s, high_rad_s = np.sort([self.speed_rad_s[:-1], self.speed_rad_s[1:]], axis=0)
        speed_rad_s = curve.speed_rad_s(self._between_deg.ravel()).reshape(self._between_deg.shape)
        off_rad_s = np.maximum(speed_rad_s - high_rad_s[:, None], low_rad_s[:, None] - speed_rad_s)
        beside = self._stands[1:] | self._stands[:-1]
        most_rad_s = np.where(beside, STANDING, _BEYOND) * np.max(np.abs(self.speed_rad_s))
        return bool(np.all(off_rad_s <= most_rad_s[:, None]))

    def pull(self, knots_deg: Array) -> Array:
        """Return rows that pull a curve to the monotone cubic between the levels.

        They say by which share it has come from one level to the next, so that their outcome is 0
        wherever the levels are. The cubic is that of Fritsch and Butland (1984),
        doi:10.1137/0905021, but level where the rotor stands: that is within a dead zone.

        Parameters
        ----------
        knots_deg
            The knots, shape (d + 1,).

        Returns
        -------
        Array
            Beside one sample, shape (P, d + 1).
        """
        slope = PchipInterpolator(self.phase_deg, self.speed_rad_s).derivative()(self.phase_deg)
        slope[self._stands] = 0.0
        cubic = CubicHermiteSpline(self.phase_deg, self.speed_rad_s, slope)(self._between_deg)
        here, there = self.speed_rad_s[:-1, None], self.speed_rad_s[1:, None]
        step = np.where(there == here, 1.0, there - here)
        share = np.where(there == here, _SHARES, (cubic - here) / step).ravel()[:, None]
        degree, left = knots_deg.size - 1, np.repeat(np.arange(here.size), _SHARES.size)
        between, at = (
            bernstein_basis(bezier_abscissa(phase_deg, knots_deg), degree)
            for phase_deg in (self._between_deg.ravel(), self.phase_deg)
        )
        rows = between - (1.0 - share) * at[left] - share * at[left + 1]
        return np.asarray(_WEIGHT / np.sqrt(_SHARES.size) * rows)

    @property
    def _stands(self) -> NDArray[np.bool_]:
        """Whether the rotor stands at a level, shape (M,)."""
        size_rad_s = np.abs(self.speed_rad_s)
        return np.asarray(size_rad_s < STANDING * np.max(size_rad_s))

    @property
    def _between_deg(self) -> Array:
        """Phases within each gap, shape (M − 1, 12)."""
        return self.phase_deg[:-1, None] + np.diff(self.phase_deg)[:, None] * _SHARES
