"""The simulation: a static curve from phase to speed, then linear dynamics of unit gain."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.model.bernstein import bezier_value
from usmbench.model.inverse_map import bezier_abscissa, check_knots

Array = NDArray[np.float64]

CREST_DEG = 90.0
"""Phase at which the wave travels most, and beside which alike: section II.1 of the paper."""
_END = 0.05  # of a curve's range: its slope over so much is that of its end
_REACH = 0.2  # of the range, beyond which a curve that goes on as it ends has levelled off


@dataclass(frozen=True, slots=True)
class StaticCurve:
    """A Bézier curve from phase to settled speed, eq. (7) and (14) of the paper.

    Parameters
    ----------
    knots_deg
        Abscissas Φ of the control points, strictly rising, shape (d + 1,).
    delta
        Ordinates δ of the control points in rad/s, shape (d + 1,).
    """

    knots_deg: Array
    delta: Array

    def __post_init__(self) -> None:
        """Refuse a curve that is none."""
        check_knots(self.knots_deg)
        if self.delta.shape != self.knots_deg.shape:
            raise ValueError(f"{self.delta.size} ordinates for {self.knots_deg.size} knots")

    @property
    def degree(self) -> int:
        """Degree d of the curve."""
        return self.knots_deg.size - 1

    def speed_rad_s(self, phase_deg: Array) -> Array:
        """Return the settled speed.

        Parameters
        ----------
        phase_deg
            Phases, shape (N,). Beyond the knots, where the paper's curve is not defined, it goes on
            as steeply as it ends, ever less so, and beyond ±90°, if it ends thereabouts or before,
            back the way it came: the wave travels as the sine of the phase. How far that is
            admissible is the caller's to know, see `usmbench.model.mixed_curve.beyond_range`.
        """
        phase_deg = self._turned_back_deg(phase_deg)
        held_deg = np.clip(phase_deg, self.knots_deg[0], self.knots_deg[-1])
        speed_rad_s = self._within(held_deg)
        beyond_deg = phase_deg - held_deg
        if np.any(beyond_deg):
            speed_rad_s += self._more_rad_s(beyond_deg)
        return speed_rad_s

    def _turned_back_deg(self, phase_deg: Array) -> Array:
        """Phases, those beyond a crest as far on this side of it.

        A curve that was measured well beyond ±90° goes on as it ends.
        """
        low_deg, high_deg = float(self.knots_deg[0]), float(self.knots_deg[-1])
        end_deg = _END * (high_deg - low_deg)
        high_crest_deg = max(CREST_DEG, high_deg) if high_deg - end_deg < CREST_DEG else np.inf
        low_crest_deg = min(-CREST_DEG, low_deg) if low_deg + end_deg > -CREST_DEG else -np.inf
        back_deg = np.where(phase_deg > high_crest_deg, 2.0 * high_crest_deg - phase_deg, phase_deg)
        return np.where(phase_deg < low_crest_deg, 2.0 * low_crest_deg - phase_deg, back_deg)

    def _within(self, phase_deg: Array) -> Array:
        return bezier_value(bezier_abscissa(phase_deg, self.knots_deg), self.delta)

    def _more_rad_s(self, beyond_deg: Array) -> Array:
        """Return what the curve gains beyond its ends."""
        low_deg, high_deg = float(self.knots_deg[0]), float(self.knots_deg[-1])
        end_deg, reach_deg = _END * (high_deg - low_deg), _REACH * (high_deg - low_deg)
        ends_deg = np.array([low_deg, low_deg + end_deg, high_deg - end_deg, high_deg])
        slopes = np.diff(self._within(ends_deg))[[0, 2]] / end_deg
        further_deg = np.copysign(reach_deg * np.expm1(-np.abs(beyond_deg) / reach_deg), beyond_deg)
        more: Array = further_deg * np.where(beyond_deg < 0.0, *slopes)
        return more


@dataclass(frozen=True, slots=True)
class LinearPart:
    """The dynamics ``ω(t) = −Σ a_i ω(t−i) + Σ b_k v(t−D−k)``, eq. (1) with a dead time.

    Parameters
    ----------
    a
        Coefficients a_1 … a_na, shape (n_a,).
    b
        Coefficients b_0 … b_nb, shape (n_b + 1,).
    dead_time_windows
        Whole windows D between a command and its first effect. What is left of the true dead
        time, a part of a window, is in b: see `usmbench.model.linear.dead_time_s`.
    window_s
        Time from one sample to the next; None where the samples are settled pairs, which have
        no time step of their own.
    slip_limit_rad_s
        Slip at which the motor's torque gives out, where the data show that large steps take
        longer; the free run is then that of `usmbench.model.torque_limit`, and a and b are its
        limit for small steps. Only beside a first-order lag; None for linear dynamics.
    """

    a: Array
    b: Array
    dead_time_windows: int
    window_s: float | None
    slip_limit_rad_s: float | None = None

    @property
    def gain(self) -> float:
        """Steady-state gain Σb / (1 + Σa), eq. (2): 1 in an identified model."""
        return float(self.b.sum() / (1.0 + self.a.sum()))


@dataclass(frozen=True, slots=True)
class OperatingPoint:
    """One static curve, and where it was measured.

    Parameters
    ----------
    frequency_hz, torque_nm
        The point; None where the run did not say.
    curve
        Its curve.
    phase_range_deg
        Lowest and highest phase it was fitted on.
    dead_zone_deg
        Lower and upper edge of the dead zone; None where the range holds no such edge.
    noise_rad_s
        Standard deviation of what the model leaves at this point, free-running.
    """

    frequency_hz: float | None
    torque_nm: float | None
    curve: StaticCurve
    phase_range_deg: tuple[float, float]
    dead_zone_deg: tuple[float | None, float | None]
    noise_rad_s: float


@dataclass(frozen=True, slots=True)
class HammersteinModel:
    """Everything a simulation needs, and what is known about it.

    Parameters
    ----------
    linear
        The shared dynamics.
    points
        The operating points, at least one.
    method
        How it was identified.
    fitted_on
        One mapping a run: name, id, rows, and the motor and counts_per_rev that it said.
    residual
        The residual's level and colour: free-run and one-step RMSE, AR coefficients.
    intervals
        95 % intervals by parameter name, where the method gives them.
    unexplained
        Structure found in the residual that this model cannot represent, one mapping each.
    effects
        Causes added by a diagnosis, as stored in the model file.
    name
        File the model was read from, for messages.
    """

    linear: LinearPart
    points: tuple[OperatingPoint, ...]
    method: str
    fitted_on: tuple[dict[str, Any], ...] = ()
    residual: dict[str, Any] = field(default_factory=dict)
    intervals: dict[str, Any] = field(default_factory=dict)
    unexplained: tuple[dict[str, Any], ...] = ()
    effects: tuple[dict[str, Any], ...] = ()
    name: str = "the model"
