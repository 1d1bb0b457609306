"""A longer time constant."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from usmbench.model.effects.base import Array, DynamicsEffect, Values
from usmbench.model.effects.context import Context
from usmbench.model.effects.first_order import Lag, lag_of
from usmbench.model.effects.parameter import Parameter
from usmbench.model.hammerstein import LinearPart

_ALIKE = 1e-3  # of a time constant: two nearer than that are taken for so far apart
_FASTEST = 1e-3  # a pole nearer to 0 is no lag at this window


class SlowDynamics(DynamicsEffect):
    """The time constant τ becomes τ + d: more inertia on the shaft, or a softer contact.

    Exact for a first-order lag; of other dynamics, the slowest real pole exp(−T/τ) moves to
    exp(−T/(τ + d)) at the same gain.
    """

    name = "slow_dynamics"
    meaning = "The motor follows with a longer time constant."
    mend = "Look for added inertia on the shaft, low preload, or a filter in the drive."
    parameters = (
        Parameter(
            "added_s",
            "s",
            0.0,
            0.0,
            10.0,
            0.002,
            scanned=True,
            what="what the time constant is longer than simulated",
        ),
    )

    def linear_part(self, linear: LinearPart, context: Context, values: Values) -> LinearPart:
        """Return the slower linear part.

        Parameters
        ----------
        linear, context, values
            As in `DynamicsEffect.linear_part`.
        """
        added_s, window_s = values["added_s"], context.window_s
        if added_s <= 0.0:
            return linear
        known = lag_of(linear, window_s)
        if known is None:
            return self._slower(linear, added_s, window_s)
        slower = self._slower_lag(known, added_s, window_s)
        return replace(slower, slip_limit_rad_s=linear.slip_limit_rad_s)

    def _slower_lag(self, lag: Lag, added_s: float, window_s: float) -> LinearPart:
        return replace(lag, tau_s=lag.tau_s + added_s).linear_part(window_s)

    def _slower(self, linear: LinearPart, added_s: float, window_s: float) -> LinearPart:
        """Return dynamics that are no lag with their slowest real pole slower."""
        poles = np.roots(np.r_[1.0, linear.a])
        real = (np.abs(poles.imag) < 1e-9) & (poles.real > _FASTEST) & (poles.real < 1.0)
        rest, tau_s = poles, 0.0
        if np.any(real):
            slowest = int(np.argmax(np.where(real, poles.real, -1.0)))
            tau_s = -window_s / math.log(float(poles.real[slowest]))
            rest = np.delete(poles, slowest)
        elif poles.size and np.min(np.abs(poles)) <= _FASTEST:
            rest = np.delete(poles, int(np.argmin(np.abs(poles))))
        pole = math.exp(-window_s / (tau_s + added_s))
        a = np.real(np.poly(np.r_[rest, pole]))[1:]
        gain = (1.0 + float(a.sum())) / float(linear.b.sum())
        return replace(linear, a=np.asarray(a, dtype=np.float64), b=linear.b * gain * linear.gain)

    def grid(self, contexts: Sequence[Context]) -> dict[str, Array]:
        """Return additions from a 500th of a window, which steps still show, to a hundred.

        Parameters
        ----------
        contexts
            All stretches.
        """
        return {"added_s": np.minimum(contexts[0].window_s * np.geomspace(0.002, 100.0, 36), 10.0)}


class AnotherLag(SlowDynamics):
    """A lag of time constant d behind the motor's own: a filter in the drive or in the counter.

    Exact behind a first-order lag; behind other dynamics, a speed is taken for straight between the
    middles of windows.
    """

    form = "another lag"
    parameters = (
        replace(SlowDynamics.parameters[0], what="time constant of the lag that is added"),
    )

    def untestable(self, contexts: Sequence[Context]) -> str | None:
        """Return why where the model's torque has a limit, which is that of a single lag.

        Parameters
        ----------
        contexts
            All stretches.
        """
        if any(c.linear.slip_limit_rad_s is not None for c in contexts):
            return "the model's torque has a limit, and is followed by one lag only"
        return None

    def _slower_lag(self, lag: Lag, added_s: float, window_s: float) -> LinearPart:
        """Return (τ L(τ) − d L(d)) / (τ − d), both lags in partial fractions."""
        if abs(added_s - lag.tau_s) < _ALIKE * lag.tau_s:
            added_s = (1.0 + _ALIKE) * lag.tau_s
        own, other = (one.linear_part(window_s) for one in (lag, replace(lag, tau_s=added_s)))
        share = lag.tau_s / (lag.tau_s - added_s)
        mine = np.convolve(own.b, np.r_[1.0, other.a])
        its = np.convolve(other.b, np.r_[1.0, own.a])
        a = np.convolve(np.r_[1.0, own.a], np.r_[1.0, other.a])[1:]
        return replace(own, a=a, b=share * mine + (1.0 - share) * its)

    def _slower(self, linear: LinearPart, added_s: float, window_s: float) -> LinearPart:
        """Return dynamics that are no lag with one behind them."""
        pole = math.exp(-window_s / added_s)
        left = (1.0 - pole) * added_s / window_s
        a = np.convolve(np.r_[1.0, linear.a], [1.0, -pole])[1:]
        return replace(linear, a=a, b=np.convolve(linear.b, [1.0 - left, left - pole]))


FORMS = (SlowDynamics(), AnotherLag())
