"""The size of the noise along the phase: of a rotor that turns, and of one that stands."""

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.robust_fit import OVER_MEDIAN

Array = NDArray[np.float64]

_BINS, _ROWS_A_BIN = 16, 60
_FEWEST = 20  # rows that tell whether one of the two differs
_LEAST_SHARE = 0.3  # of the middle level: a standing rotor shows none, yet is not exact


def levels(
    phase_deg: Array, error_rad_s: Array, dead_zone_deg: tuple[float, float]
) -> tuple[Array, Array]:
    """Return phases, rising, and the robust standard deviation there in rad/s, shape (K,) each.

    A bin has rows of a rotor that turns, or of one that stands; the level passes from the one to
    the other at the end of the dead zone, wherever the nearest phases are that were driven.

    Parameters
    ----------
    phase_deg, error_rad_s
        Phases, and what is left there, shape (N,).
    dead_zone_deg
        Lowest and highest phase at which the rotor stands.
    """
    n_bins = int(np.clip(phase_deg.size // _ROWS_A_BIN, 1, _BINS))
    low_deg, high_deg = dead_zone_deg
    nodes, sigma = [], []
    for rows, begin_deg, end_deg in (
        (phase_deg < low_deg, -np.inf, low_deg),
        ((phase_deg >= low_deg) & (phase_deg <= high_deg), low_deg, high_deg),
        (phase_deg > high_deg, high_deg, np.inf),
    ):
        n_rows = np.count_nonzero(rows)
        if n_rows < _FEWEST:
            continue
        n_own = max(1, round(n_bins * n_rows / phase_deg.size))
        centres, sizes = _binned(phase_deg[rows], error_rad_s[rows], n_own)
        nodes += [begin_deg, *centres, end_deg]
        sigma += [sizes[0], *sizes, sizes[-1]]
    if not nodes:
        nodes, sigma = map(list, _binned(phase_deg, error_rad_s, n_bins))
    within = np.isfinite(nodes)
    found_deg, level = np.array(nodes)[within], np.array(sigma)[within]
    middle = float(np.sqrt(np.mean(np.interp(phase_deg, found_deg, level) ** 2)))
    return found_deg, np.maximum(level, _LEAST_SHARE * max(middle, 1e-9))


def _binned(phase_deg: Array, error: Array, n_bins: int) -> tuple[Array, Array]:
    """Return mean phases and levels of bins of equal numbers of rows."""
    bins = np.array_split(np.argsort(phase_deg, kind="stable"), n_bins)
    centres = np.array([np.mean(phase_deg[rows]) for rows in bins])
    return centres, np.array([_spread(error[rows]) for rows in bins])


def _spread(values: Array) -> float:
    """Robust standard deviation about 0: by the median, but not below the trimmed one."""
    size = np.abs(values)
    trimmed = values[size <= np.quantile(size, 0.98)]
    return max(OVER_MEDIAN * float(np.median(size)), float(np.sqrt(np.mean(trimmed**2))))
