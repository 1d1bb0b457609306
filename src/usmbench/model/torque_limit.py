"""A first-order lag whose torque has a limit, exactly, for speeds averaged over windows.

The contact's torque grows with the slip v − ω and saturates, so that

    dω/dt = (s/τ) tanh((v − ω)/s)

with the slip s at which it gives out; small steps see a lag τ, large ones take longer. Over a
time t of constant v, y = (v − ω)/s obeys ``sinh y(t) = sinh y(0) exp(−t/τ)``, and ∫ y dt is
``τ (G(y(0)) − G(y(t)))`` with ``G(y) = ∫ y coth y dy``.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.special import spence

Array = NDArray[np.float64]

_HIGHEST = 300.0  # y beyond which sinh would overflow; saturated long before
_SAME = 1e-10  # of the largest speed


def limited_run(
    tau_windows: float,
    dead_windows: float,
    slip_limit_rad_s: float,
    settled_rad_s: Array,
    start_rad_s: float,
) -> Array:
    """Return the mean speed of each window.

    Parameters
    ----------
    tau_windows, dead_windows
        Time constant and dead time in windows.
    slip_limit_rad_s
        Slip s at which the torque gives out.
    settled_rad_s
        Settled speed commanded in each window, shape (N,).
    start_rad_s
        Settled speed before the first window.

    Returns
    -------
    Array
        Shape (N,).
    """
    whole = int(dead_windows)
    late = np.r_[np.full(whole + 1, start_rad_s), settled_rad_s][: settled_rad_s.size + 1]
    part = dead_windows - whole
    window = _Window(late[:-1], late[1:], part, tau_windows, slip_limit_rad_s)
    slips = _window_slips(window, start_rad_s)
    # A window begins where the one before ended.
    ended = _slip_integral(slips.last)
    lost = np.r_[_slip_integral(slips.first[:1]), ended[:-1]] - ended
    lost[window.changed] += _slip_integral(slips.right) - _slip_integral(slips.left)
    mean: Array = part * window.before + (1.0 - part) * window.after
    mean -= slip_limit_rad_s * tau_windows * lost
    return mean


@dataclass(frozen=True, slots=True)
class _Slips:
    """Slips over s: at a window's first and last moment, and on both sides of a change in it."""

    first: Array
    left: Array
    right: Array
    last: Array


class _Window:
    """Two parts of every window: until the dead time ends, and after it."""

    def __init__(self, before: Array, after: Array, part: float, tau: float, slip: float) -> None:
        self.before, self.after = before, after
        self.decay = np.exp(-1.0 / tau)
        self.changed = np.flatnonzero(after != before)
        self._jump = (after - before)[self.changed] / slip
        self._decays = np.exp(-part / tau), np.exp(-(1.0 - part) / tau)
        self._slip = slip

    def slips(self, begin: Array) -> _Slips:
        """Slips of windows that begin at these speeds."""
        first = np.clip((self.before - begin) / self._slip, -_HIGHEST, _HIGHEST)
        fading = np.sinh(first) * self._decays[0]
        left = np.arcsinh(fading[self.changed])
        right = np.clip(self._jump + left, -_HIGHEST, _HIGHEST)
        fading[self.changed] = np.sinh(right)
        return _Slips(first, left, right, np.arcsinh(fading * self._decays[1]))

    def ends(self, slips: _Slips) -> Array:
        """Speed at the end of each window."""
        end: Array = self.after - self._slip * slips.last
        return end


def _window_slips(window: _Window, start_rad_s: float) -> _Slips:
    """Slips of every window, each begun as the one before ends.

    The linear lag is solved for what the limit adds to it, over and over: each round is right for
    one window more at least, and for all of them once the saturated windows are behind.
    """
    begin: Array = np.r_[start_rad_s, window.before[1:]]
    close = _SAME * max(float(np.max(np.abs(begin))), 1e-300)
    for _ in range(begin.size + 1):
        slips = window.slips(begin)
        added = window.ends(slips) - window.decay * begin
        filtered, _ = lfilter(
            [1.0], [1.0, -window.decay], added[:-1], zi=[window.decay * start_rad_s]
        )
        moved = np.r_[start_rad_s, filtered]
        if np.max(np.abs(moved - begin)) <= close:
            break
        begin = moved
    return slips


def _slip_integral(y: Array) -> Array:
    """G(y) = ∫ t coth t dt from 0 to y, by the dilogarithm; odd in y."""
    size = np.maximum(np.abs(y), 1e-300)
    gone = -np.expm1(-2.0 * size)
    rising = 0.5 * size**2 + size * np.log(gone) + 0.5 * (np.pi**2 / 6.0 - spence(gone))
    signed: Array = np.copysign(rising, y)
    return signed
