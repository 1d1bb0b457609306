"""The size of the noise along the phase: of a rotor that turns, and of one that stands."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.robust_fit import OVER_MEDIAN

Array = NDArray[np.float64]

_BINS, _ROWS_A_BIN = 16, 60
_FEWEST = 20  # rows that tell whether one of the two differs
_LEAST_SHARE = 0.3  # of the middle level: a standing rotor shows none, yet is not exact
_GAP = 0.5  # of the way between two bins: more without a row, and no line across is measured


class _Bin(NamedTuple):
    """Rows of neighbouring phases: the lowest, the mean, the highest, and their level."""

    low_deg: float
    mean_deg: float
    high_deg: float
    sigma_rad_s: float


def levels(
    phase_deg: Array, error_rad_s: Array, dead_zone_deg: tuple[float, float]
) -> tuple[Array, Array]:
    """Return phases, rising, and the robust standard deviation there in rad/s, shape (K,) each.

    A bin has rows of a rotor that turns, or of one that stands. Where the one passes to the other,
    and wherever no phase was driven, nothing says where the noise changes: it is the larger one.

    Parameters
    ----------
    phase_deg, error_rad_s
        Phases, and what is left there, shape (N,).
    dead_zone_deg
        Lowest and highest phase at which the rotor stands.
    """
    n_bins = int(np.clip(phase_deg.size // _ROWS_A_BIN, 1, _BINS))
    low_deg, high_deg = dead_zone_deg
    regions = []
    for rows in (
        phase_deg < low_deg,
        (phase_deg >= low_deg) & (phase_deg <= high_deg),
        phase_deg > high_deg,
    ):
        n_rows = np.count_nonzero(rows)
        if n_rows >= _FEWEST:
            n_own = max(1, round(n_bins * n_rows / phase_deg.size))
            regions.append(_binned(phase_deg[rows], error_rad_s[rows], n_own))
    nodes = _nodes(regions or [_binned(phase_deg, error_rad_s, n_bins)])
    found_deg, level = np.array(nodes).T
    middle = float(np.sqrt(np.mean(np.interp(phase_deg, found_deg, level) ** 2)))
    return found_deg, np.maximum(level, _LEAST_SHARE * max(middle, 1e-9))


def _nodes(regions: Sequence[Sequence[_Bin]]) -> list[tuple[float, float]]:
    """Return phases and levels between which the level is a line."""
    bins = [one for region in regions for one in region]
    ends = np.cumsum([len(region) for region in regions])
    nodes = [(bins[0].mean_deg, bins[0].sigma_rad_s)]
    for n, (one, other) in enumerate(pairwise(bins), start=1):
        gap_deg = other.low_deg - one.high_deg
        if n in ends or gap_deg > _GAP * (other.mean_deg - one.mean_deg):
            most = max(one.sigma_rad_s, other.sigma_rad_s)
            beyond = (np.nextafter(one.high_deg, np.inf), np.nextafter(other.low_deg, -np.inf))
            nodes.append((one.high_deg, one.sigma_rad_s))
            nodes += [(float(deg), most) for deg in sorted(beyond)]
            nodes.append((other.low_deg, other.sigma_rad_s))
        nodes.append((other.mean_deg, other.sigma_rad_s))
    return list(dict.fromkeys(nodes))


def _binned(phase_deg: Array, error: Array, n_bins: int) -> list[_Bin]:
    """Return bins of about equal numbers of rows; a phase lies in one of them."""
    order = np.argsort(phase_deg, kind="stable")
    phases, errors = phase_deg[order], error[order]
    even = np.linspace(0, phases.size, n_bins + 1)[1:-1].astype(np.intp)
    cuts = np.unique(np.searchsorted(phases, phases[even]))
    parts = zip(np.split(phases, cuts), np.split(errors, cuts), strict=True)
    return [
        _Bin(
            float(deg[0]),
            float(np.clip(np.mean(deg), deg[0], deg[-1])),
            float(deg[-1]),
            _spread(left),
        )
        for deg, left in parts
        if deg.size
    ]


def _spread(values: Array) -> float:
    """Robust standard deviation about 0: by the median, but not below the trimmed one."""
    size = np.abs(values)
    trimmed = values[size <= np.quantile(size, 0.98)]
    return max(OVER_MEDIAN * float(np.median(size)), float(np.sqrt(np.mean(trimmed**2))))
