"""A first-order lag whose torque has a limit, exactly, for speeds averaged over windows.

The contact's torque grows with the slip v − ω and saturates, so that

    dω/dt = (s/τ) tanh((v − ω)/s)

with the slip s at which it gives out; small steps see a lag τ, large ones take longer. Over a
time t of constant v, y = (v − ω)/s obeys ``sinh y(t) = sinh y(0) exp(−t/τ)``, and ∫ y dt is
``τ (G(y(0)) − G(y(t)))`` with ``G(y) = ∫ y coth y dy``.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dtbtrs
from scipy.special import spence

Array = NDArray[np.float64]

_HIGHEST = 300.0  # y beyond which sinh would overflow; saturated long before
_CLOSE = 1e-5  # of s; Newton's next step would be the square of it


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
    part = dead_windows - whole
    late = np.concatenate((np.full(whole + 1, start_rad_s), settled_rad_s))
    late = late[: settled_rad_s.size + 1]
    changing = late[1:] != late[:-1]
    # The shaft starts settled, as if after a change of nothing.
    changes = np.append(-1, np.flatnonzero(changing))
    jumps = np.append(0.0, np.diff(late)[changing]) / slip_limit_rad_s
    slips = _slips_after(jumps, np.diff(changes) / tau_windows)
    latest = np.cumsum(changing)
    since = np.arange(1.0, late.size) - part - changes[latest]
    ended = _slip_integral(_faded(slips[latest], since / tau_windows))
    lost = -np.diff(ended, prepend=0.0)
    lost[changing] += (_slip_integral(slips) - _slip_integral(slips - jumps))[1:]
    mean: Array = part * late[:-1] + (1.0 - part) * late[1:]
    mean -= slip_limit_rad_s * tau_windows * lost
    return mean


def _slips_after(jumps: Array, gaps: Array) -> Array:
    """Slips over s just after each change of v, the gaps between them in time constants.

    A jump adds to what is left of the slip after the change before. Each round of Newton's method
    is right for one change more at least, and for all of them once it is near.
    """
    slips = jumps
    band = np.ones((2, jumps.size), order="F")
    for _ in range(jumps.size):
        left = _faded(slips[:-1], gaps)
        band[1, :-1] = -_fading_slope(slips[:-1], left, gaps)
        step = dtbtrs(band, np.append(0.0, left) + jumps - slips, uplo="L")[0]
        slips = slips + step
        if np.max(np.abs(step)) < _CLOSE:
            break
    return slips


def _faded(y: Array, gaps: Array) -> Array:
    """Slips as many time constants later."""
    size = np.abs(y)
    grown = size - gaps
    over = np.maximum(grown - _HIGHEST, 0.0)
    sinh = -0.5 * np.exp(grown - over) * np.expm1(-2.0 * size)
    faded: Array = np.copysign(np.arcsinh(sinh) + over, y)
    return faded


def _fading_slope(y: Array, faded: Array, gaps: Array) -> Array:
    """How faded slips change with the slips: exp(−gap) cosh y / cosh faded."""
    size, left = np.abs(y), np.abs(faded)
    slope: Array = np.exp(size - left - gaps)
    slope *= (1.0 + np.exp(-2.0 * size)) / (1.0 + np.exp(-2.0 * left))
    return slope


def _slip_integral(y: Array) -> Array:
    """G(y) = ∫ t coth t dt from 0 to y, by the dilogarithm; odd in y."""
    rising = 0.5 * (y**2 + spence(np.exp(-2.0 * np.abs(y))))
    signed: Array = np.copysign(rising, y)
    return signed
