"""A first-order lag whose torque has a limit, exactly, for speeds averaged over windows.

The contact's torque grows with the slip v − ω and saturates, so that

    dω/dt = (s/τ) tanh((v − ω)/s)

with the slip s at which it gives out; small steps see a lag τ, large ones take longer. Over a
time t of constant v, y = (v − ω)/s obeys ``sinh y(t) = sinh y(0) exp(−t/τ)``, and ∫ y dt is
``τ (G(y(0)) − G(y(t)))`` with ``G(y) = ∫ y coth y dy``.
"""

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
    begin = _window_starts(window, start_rad_s)
    y = window.slips(begin)
    lost = _slip_integral(y[0]) - _slip_integral(y[1]) + _slip_integral(y[2])
    lost -= _slip_integral(y[3])
    mean: Array = part * window.before + (1.0 - part) * window.after
    return mean - slip_limit_rad_s * tau_windows * lost


class _Window:
    """Two parts of every window: until the dead time ends, and after it."""

    def __init__(self, before: Array, after: Array, part: float, tau: float, slip: float) -> None:
        self.before, self.after = before, after
        self.decay = np.exp(-1.0 / tau)
        self._decays = np.exp(-part / tau), np.exp(-(1.0 - part) / tau)
        self._slip = slip

    def slips(self, begin: Array) -> tuple[Array, Array, Array, Array]:
        """Slips over s at both ends of the first part, and of the second."""
        slip = self._slip
        first = np.clip((self.before - begin) / slip, -_HIGHEST, _HIGHEST)
        left = np.arcsinh(np.sinh(first) * self._decays[0])
        second = np.clip((self.after - self.before) / slip + left, -_HIGHEST, _HIGHEST)
        return first, left, second, np.arcsinh(np.sinh(second) * self._decays[1])

    def ends(self, begin: Array) -> Array:
        """Speed at the end of each window."""
        end: Array = self.after - self._slip * self.slips(begin)[3]
        return end


def _window_starts(window: _Window, start_rad_s: float) -> Array:
    """Speed at the start of each window.

    The linear lag is solved for what the limit adds to it, over and over: each round is right for
    one window more at least, and for all of them once the saturated windows are behind.
    """
    begin: Array = np.r_[start_rad_s, window.before[1:]]
    close = _SAME * max(float(np.max(np.abs(begin))), 1e-300)
    for _ in range(begin.size):
        added = window.ends(begin) - window.decay * begin
        filtered, _ = lfilter(
            [1.0], [1.0, -window.decay], added[:-1], zi=[window.decay * start_rad_s]
        )
        moved = np.r_[start_rad_s, filtered]
        settled = np.max(np.abs(moved - begin)) <= close
        begin = moved
        if settled:
            break
    return begin


def _slip_integral(y: Array) -> Array:
    """G(y) = ∫ t coth t dt from 0 to y, by the dilogarithm; odd in y."""
    size = np.maximum(np.abs(y), 1e-300)
    gone = -np.expm1(-2.0 * size)
    rising = 0.5 * size**2 + size * np.log(gone) + 0.5 * (np.pi**2 / 6.0 - spence(gone))
    signed: Array = np.copysign(rising, y)
    return signed
