"""A first-order lag whose torque has a limit, exactly, for speeds averaged over windows.

The contact's torque grows with the slip v − ω and saturates, so that

    dω/dt = (s/τ) tanh((v − ω)/s)

with the slip s at which it gives out; small steps see a lag τ, large ones take longer. Over a
time t of constant v, y = (v − ω)/s obeys ``sinh y(t) = sinh y(0) exp(−t/τ)``, and ∫ y dt is
``τ (G(y(0)) − G(y(t)))`` with ``G(y) = ∫ y coth y dy``.

So ``u = log sinh |y|``, the slip's level here, falls by t/τ, and ``dy/du = tanh y``,
``dG/du = y``. Both are taken from a table over u, by Taylor's third order: a diagnosis runs the
simulation some thousand times.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dtbtrs
from scipy.special import spence

Array = NDArray[np.float64]

_TINY = 1e-12  # of s: no slip at all has no level
_CLOSE = 1e-5  # of s; Newton's next step would be the square of it
_STEP, _LOWEST, _HIGHEST = 1.0 / 128.0, -40.0, 20.0  # of levels; y is 4e-18 and u + log 2 there
_LEVELS = np.arange(_LOWEST, _HIGHEST + _STEP / 2.0, _STEP)
_SLIPS = np.arcsinh(np.exp(_LEVELS))
_SLOPES = np.tanh(_SLIPS)
_BENDS = _SLOPES * (1.0 - _SLOPES**2)
# By the dilogarithm.
_INTEGRALS = 0.5 * (_SLIPS**2 + spence(np.exp(-2.0 * _SLIPS)))


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
    return limited_runs(
        tau_windows, dead_windows, slip_limit_rad_s, [settled_rad_s], [start_rad_s]
    )[0]


def limited_runs(
    tau_windows: float,
    dead_windows: float,
    slip_limit_rad_s: float,
    settled_rad_s: Sequence[Array],
    start_rad_s: Sequence[float],
) -> list[Array]:
    """Return the mean speed of each window of several runs, which cost as much as one as long.

    Parameters
    ----------
    tau_windows, dead_windows, slip_limit_rad_s
        As in `limited_run`.
    settled_rad_s, start_rad_s
        As in `limited_run`, one a run.

    Returns
    -------
    list of Array
        Shape (N,) each.
    """
    whole = int(dead_windows)
    part = dead_windows - whole
    parts = zip(settled_rad_s, start_rad_s, strict=True)
    lates = [np.concatenate((np.full(whole + 1, v), s))[: s.size + 1] for s, v in parts]
    sizes = np.array([late.size for late in lates])
    ends, late = np.cumsum(sizes), np.concatenate(lates)
    changing = np.empty(late.size, dtype=np.bool_)
    np.not_equal(late[1:], late[:-1], out=changing[1:])
    # The shaft starts settled, as if after a change of nothing.
    begins = ends - sizes
    changing[begins] = True
    changes = np.flatnonzero(changing)
    first = np.searchsorted(changes, begins)
    jumps = (late[changes] - late[changes - 1]) / slip_limit_rad_s
    gaps = np.diff(changes) / tau_windows
    jumps[first], gaps[first[1:] - 1] = 0.0, np.inf
    slips = _slips_after(jumps, gaps)
    levels = _level(slips)[0]
    lasts = np.diff(changes, append=late.size)
    since = np.arange(1.0 - part, late.size + 0.5 - part) - np.repeat(changes, lasts)
    ended = _slip_integral(np.repeat(levels, lasts) - since / tau_windows, np.repeat(slips, lasts))
    lost = -np.diff(ended, prepend=0.0)
    lost[changes[1:]] += _slip_integral(levels[1:], slips[1:])
    lost[changes[1:]] -= _slip_integral(levels[:-1] - gaps, slips[:-1])
    mean = (1.0 - part) * late
    mean[1:] += part * late[:-1]
    mean -= slip_limit_rad_s * tau_windows * lost
    return [mean[begin + 1 : end] for begin, end in zip(begins, ends, strict=True)]


def _slips_after(jumps: Array, gaps: Array) -> Array:
    """Slips over s just after each change of v, the gaps between them in time constants.

    A jump adds to what is left of the slip after the change before. Each round of Newton's method
    is right for one change more at least, and for all of them once it is near.
    """
    slips = jumps
    band = np.ones((2, jumps.size), order="F")
    for _ in range(jumps.size):
        level, risen = _level(slips[:-1])
        left, slope = _faded(level - gaps, slips[:-1])
        band[1, :-1] = -slope / risen
        step = dtbtrs(band, np.append(0.0, left) + jumps - slips, uplo="L")[0]
        slips = slips + step
        if np.max(np.abs(step)) < _CLOSE:
            break
    return slips


def _level(y: Array) -> tuple[Array, Array]:
    """Level log sinh |y| of slips, and dy/du there."""
    size = np.maximum(np.abs(y), _TINY)
    fallen = -np.expm1(-2.0 * size)
    return size + np.log(0.5 * fallen), fallen / (2.0 - fallen)


def _faded(level: Array, sign: Array) -> tuple[Array, Array]:
    """Slips y of a level, of the signs given, and dy/du there."""
    node, beyond = _nearest(level)
    slope, bend = _SLOPES.take(node), _BENDS.take(node)
    bend *= beyond
    twist = bend * beyond * (1.0 - 3.0 * slope**2)
    size = _SLIPS.take(node) + beyond * (slope + bend / 2.0 + twist / 6.0)
    faded: Array = np.copysign(size, sign)
    return faded, slope + bend


def _slip_integral(level: Array, sign: Array) -> Array:
    """G(y) = ∫ t coth t dt from 0 to y of slips y of a level, of the signs given; odd in y."""
    node, beyond = _nearest(level)
    size = _BENDS.take(node)
    size *= beyond / 3.0
    size += _SLOPES.take(node)
    size *= beyond / 2.0
    size += _SLIPS.take(node)
    size *= beyond
    size += _INTEGRALS.take(node)
    signed: Array = np.copysign(size, sign, out=size)
    return signed


def _nearest(level: Array) -> tuple[NDArray[np.intp], Array]:
    """Node of the table nearest to each level, and how far beyond it the level is.

    Taylor's series is exact beyond the last one.
    """
    held = np.maximum(level, _LOWEST)
    place = held - (_LOWEST - _STEP / 2.0)
    place /= _STEP
    node = np.minimum(place, _LEVELS.size - 1.0, out=place).astype(np.intp)
    held -= _LEVELS.take(node)
    return node, held
