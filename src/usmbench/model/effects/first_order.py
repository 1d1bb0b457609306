"""The first-order lag behind a delay, exactly, for speeds averaged over windows or sampled."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from usmbench.model.effects.base import Array
from usmbench.model.hammerstein import LinearPart
from usmbench.model.linear import dead_time_s, time_constant_s

_SAME = 0.03  # largest difference of a coefficient that still is the same lag
# Of a window: by as much speeds that are averages may follow too soon, as those of a simulation in
# four whole steps do. Without it they pass for samples behind a delay.
SOONER = 0.13
_EXACT = 1e-6  # difference that is none
_FASTEST = 1e-3  # of a window: a lag faster than this is none


@dataclass(frozen=True, slots=True)
class Lag:
    """A first-order lag behind a delay.

    Parameters
    ----------
    tau_s
        Time constant τ.
    delay_s
        Delay.
    sampled
        Whether speeds are those at the ends of windows, as in the paper's difference equation, and
        not averages over windows.
    """

    tau_s: float
    delay_s: float
    sampled: bool = False

    def linear_part(self, window_s: float) -> LinearPart:
        """Return the difference equation.

        Parameters
        ----------
        window_s
            Duration T of a window.
        """
        tau = max(self.tau_s / window_s, _FASTEST)
        whole = int(self.delay_s / window_s)
        pole, b = lag_coefficients(tau, self.delay_s / window_s - whole, sampled=self.sampled)
        return LinearPart(np.array([-pole]), b, whole, window_s)


def lag_coefficients(
    tau_windows: float, delay_windows: float, *, sampled: bool
) -> tuple[float, Array]:
    """Return the pole and the numerator of a lag behind a delay of a part of a window.

    A step at the start of a window acts for u in the window in which the delay ends, which then
    averages s_0 = u/T − (τ/T)(1 − exp(−u/τ)) and ends at 1 − exp(−u/τ); in each window after, the
    distance to the end shrinks by p = exp(−T/τ). One that acts since before the window averages
    s_0 = 1 − (τ/T)(1 − p) exp((T − u)/τ). That is the difference equation with a_1 = −p and
    three b; of speeds at the ends of windows two, and without a delay one, the paper's with
    n_a = 1, n_b = 0.

    Parameters
    ----------
    tau_windows
        Time constant τ over the duration T of a window.
    delay_windows
        The delay's part of a window, 0 to 1; of averages also a little below 0.
    sampled
        Whether speeds are those at the ends of windows.

    Returns
    -------
    pole, b
        p, and b_0 to b_2, shape (3,).
    """
    acts = 1.0 - delay_windows
    pole, left = math.exp(-1.0 / tau_windows), math.exp(-acts / tau_windows)
    if sampled:
        return pole, np.array([1.0 - left, left - pole, 0.0])
    first = acts + tau_windows * math.expm1(-acts / tau_windows)
    if acts > 1.0:  # since before the window
        first = 1.0 - tau_windows * (1.0 - pole) * math.exp((1.0 - acts) / tau_windows)
    second = 1.0 - tau_windows * (1.0 - pole) * left
    return pole, np.array(
        [first, second - (1.0 + pole) * first, 1.0 - pole - second + pole * first]
    )


def lag_of(linear: LinearPart, window_s: float) -> Lag | None:
    """Return the lag and the delay of a linear part that is nothing else, or None.

    Parameters
    ----------
    linear
        The linear part.
    window_s
        Duration of a window.
    """
    a, b = tuple(linear.a.tolist()), tuple(linear.b.tolist())
    return _lag_of(a, b, linear.dead_time_windows, linear.window_s, window_s)


@lru_cache(maxsize=64)  # a search asks thousands of times about one model
def _lag_of(
    a: tuple[float, ...],
    b: tuple[float, ...],
    dead_time_windows: int,
    step_s: float | None,
    window_s: float,
) -> Lag | None:
    linear = LinearPart(np.array(a, float), np.array(b, float), dead_time_windows, step_s)
    tau_s, delay_s = time_constant_s(linear), dead_time_s(linear)
    if tau_s is None or delay_s is None or linear.a.size != 1:
        return None
    lags = []
    if delay_s > -min(SOONER * window_s, tau_s):
        # What comes before the window is in no mean delay.
        sooner_s = tau_s * math.log1p(delay_s / tau_s) if delay_s < 0.0 else delay_s
        lags.append(Lag(tau_s, sooner_s))
    pole, left = -float(linear.a[0]), 1.0 - float(linear.b[0])
    if pole - _SAME < left < 1.0:
        acts_s = min(-tau_s * math.log(max(left, pole)), window_s)
        late_s = (linear.dead_time_windows + 1.0) * window_s - acts_s
        lags.append(Lag(tau_s, late_s, sampled=True))
    # A lag too short to show in samples would still show in averages. Where both are the same
    # equation, the one that needs less of a delay is meant.
    offs = [_off(lag.linear_part(window_s), linear) for lag in lags]
    least = min(offs, default=_SAME)
    near = (lag for lag, off in zip(lags, offs, strict=True) if off < least + _EXACT)
    return min(near, key=lambda lag: abs(lag.delay_s)) if least < _SAME else None


def true_dead_time_s(linear: LinearPart) -> float | None:
    """Return how late commands act, whichever way speeds are read.

    Parameters
    ----------
    linear
        The difference equation.

    Returns
    -------
    float or None
        As of `net_delay_s`, but 0 where the response runs a little ahead of its time constants.
    """
    delay_s = net_delay_s(linear)
    return None if delay_s is None else max(delay_s, 0.0)


def net_delay_s(linear: LinearPart) -> float | None:
    """Return the mean delay of a response less its time constants, whichever way speeds are read.

    Parameters
    ----------
    linear
        The difference equation.

    Returns
    -------
    float or None
        The delay of a lag that is sampled; else what `usmbench.model.linear.dead_time_s` says,
        which takes speeds for averages over windows.
    """
    lag = None if linear.window_s is None else lag_of(linear, linear.window_s)
    return lag.delay_s if lag is not None and lag.sampled else dead_time_s(linear)


def first_order(tau_s: float, delay_s: float, window_s: float) -> LinearPart:
    """Return the linear part of a lag behind a delay, for speeds averaged over windows.

    Parameters
    ----------
    tau_s
        Time constant.
    delay_s
        Delay.
    window_s
        Duration of a window.
    """
    return Lag(tau_s, delay_s).linear_part(window_s)


def later(linear: LinearPart, delay_s: float, window_s: float) -> LinearPart:
    """Return a linear part behind a further delay.

    Exact for a first-order lag; of other dynamics, a part of a window mixes two neighbouring
    values.

    Parameters
    ----------
    linear
        The linear part.
    delay_s
        The delay, 0 or more.
    window_s
        Duration of a window.
    """
    if delay_s <= 0.0:
        return linear
    known = lag_of(linear, window_s)
    if known is not None:
        late = replace(known, delay_s=known.delay_s + delay_s).linear_part(window_s)
        return replace(late, slip_limit_rad_s=linear.slip_limit_rad_s)
    whole = int(delay_s / window_s)
    part = delay_s / window_s - whole
    b = np.convolve(linear.b, [1.0 - part, part])
    return replace(linear, b=b, dead_time_windows=linear.dead_time_windows + whole)


def _off(one: LinearPart, other: LinearPart) -> float:
    """Largest difference of two numerators with their delays."""
    n = 4 + sum(linear.dead_time_windows + linear.b.size for linear in (one, other))
    return float(np.max(np.abs(_padded(one, n) - _padded(other, n))))


def _padded(linear: LinearPart, n: int) -> Array:
    """Numerator with its delay, over n windows."""
    padded = np.zeros(n)
    padded[linear.dead_time_windows :][: linear.b.size] = linear.b
    return padded
