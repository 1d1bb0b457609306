"""Identify curve and dynamics through a counter that tells less than the speed.

What a counter does (it may lose the sign) is in place while the free run is fitted, by least
squares over everything at once: the dynamics ``B(q)/(1 + A(q))`` of unit gain, the curve's
ordinates, the effect's parameters, and what each stretch started from.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.identify.design import stacked_basis
from usmbench.identify.dynamics import FreeFamily
from usmbench.identify.prior_rows import prior_rows
from usmbench.model.applied import Applied
from usmbench.model.extended import counted
from usmbench.model.hammerstein import LinearPart, StaticCurve
from usmbench.model.linear import free_run

Array = NDArray[np.float64]

_STIFFNESS = 1e-3  # of the curve; see `usmbench.identify.prior_rows.prior_rows`
_START = 1e-2  # pull of a start to where it was, for where no row that counts remembers it
_MOST_STEPS = 60
_FAR = 1e3  # times the highest speed: the residual where the dynamics are not stable


@dataclass(frozen=True, slots=True)
class Estimated:
    """A fit.

    Parameters
    ----------
    linear
        The dynamics.
    curve
        The static curve.
    applied
        The counter's effect; None for a counter that shows the speed as it is.
    start_rad_s
        Settled speed before each stretch.
    left_rad_s
        Measured less simulated speed of each stretch, shape (N,).
    """

    linear: LinearPart
    curve: StaticCurve
    applied: Applied | None
    start_rad_s: Array
    left_rad_s: tuple[Array, ...]

    @property
    def mean_square(self) -> float:
        """Mean square of what is left, in (rad/s)²."""
        return float(np.mean(np.concatenate(self.left_rad_s) ** 2))


def fit_through(stretches: Sequence[Stretch], masks: Sequence[Mask], start: Estimated) -> Estimated:
    """Fit curve, dynamics and the counter's effect together.

    Parameters
    ----------
    stretches
        The runs.
    masks
        Rows of each stretch that count.
    start
        Where to start; its orders, dead time, knots and effect stay.
    """
    course = _Course(stretches, masks, start)
    first = course.vector(start)
    low, high = np.full(first.size, -np.inf), np.full(first.size, np.inf)
    low[course.sizing] = [p.low for p in course.parameters]
    high[course.sizing] = [p.high for p in course.parameters]
    solved = least_squares(
        course.residual, first, bounds=(low, high), x_scale="jac", max_nfev=_MOST_STEPS
    )
    return course.estimated(solved.x)


class _Course:
    """The free run as a function of all that is fitted: a, β, δ, the effect, the starts."""

    def __init__(self, stretches: Sequence[Stretch], masks: Sequence[Mask], start: Estimated):
        linear, knots_deg = start.linear, start.curve.knots_deg
        self._stretches, self._masks, self._start = stretches, masks, start
        self.parameters = () if start.applied is None else start.applied.effect.parameters
        self._family = FreeFamily(linear.a.size, linear.b.size - 1, linear.dead_time_windows)
        held_deg = [np.clip(s.context.phase_deg, knots_deg[0], knots_deg[-1]) for s in stretches]
        self._bases = stacked_basis(held_deg, knots_deg)
        n_rows = sum(int(np.count_nonzero(mask)) for mask in masks)
        self._pull = prior_rows(knots_deg, _STIFFNESS, None, n_rows)
        self._far = _FAR * max(float(np.max(np.abs(s.speed_rad_s))) for s in stretches)
        sizes = (
            linear.a.size + linear.b.size - 1,
            knots_deg.size,
            len(self.parameters),
            len(stretches),
        )
        ends = np.cumsum(sizes)
        self._moving, self._bending, self.sizing, self._starting = (
            slice(end - size, end) for end, size in zip(ends.tolist(), sizes, strict=True)
        )

    def vector(self, estimated: Estimated) -> Array:
        """Return the parameters of a fit."""
        linear, applied = estimated.linear, estimated.applied
        sizes = [] if applied is None else [applied.values[p.name] for p in self.parameters]
        beta = linear.b[1:] / linear.b.sum()
        joined: Array = np.r_[linear.a, beta, estimated.curve.delta, sizes, estimated.start_rad_s]
        return joined

    def residual(self, theta: Array) -> Array:
        """Return what is left on the rows that count, and what pulls, shape (M,)."""
        moved_rad_s = theta[self._starting] - self._start.start_rad_s
        pull = np.r_[self._pull @ theta[self._bending], _START * moved_rad_s]
        if not self._family.dynamics(theta[self._moving]).stable:
            left = [np.full(mask.size, self._far) for mask in self._masks]
        else:
            left = self._left_rad_s(theta)
        parts = [e[mask] for e, mask in zip(left, self._masks, strict=True)]
        joined: Array = np.concatenate([*parts, pull])
        return joined

    def estimated(self, theta: Array) -> Estimated:
        """Return the fit at these parameters."""
        return Estimated(
            self._linear(theta),
            StaticCurve(self._start.curve.knots_deg, theta[self._bending]),
            self._applied(theta),
            theta[self._starting],
            tuple(self._left_rad_s(theta)),
        )

    def _linear(self, theta: Array) -> LinearPart:
        window_s = self._start.linear.window_s
        return self._family.dynamics(theta[self._moving]).linear_part(window_s)

    def _applied(self, theta: Array) -> Applied | None:
        if self._start.applied is None:
            return None
        sizes = theta[self.sizing].tolist()
        values = {p.name: size for p, size in zip(self.parameters, sizes, strict=True)}
        return Applied(self._start.applied.effect, values)

    def _left_rad_s(self, theta: Array) -> list[Array]:
        linear, applied, delta = self._linear(theta), self._applied(theta), theta[self._bending]
        effects = [] if applied is None else [applied]
        left = []
        for stretch, basis, start_rad_s in zip(
            self._stretches, self._bases, theta[self._starting].tolist(), strict=True
        ):
            shaft_rad_s = free_run(linear, basis @ delta, start_rad_s)
            left.append(stretch.speed_rad_s - counted(effects, shaft_rad_s, stretch.context))
        return left
