"""A start for the search without a guess: least squares, then the nearest product of b and δ.

In ``ω(t) = −Σ a_i ω(t−i) + Σ_k Θ_k · B(t−D−k)`` the matrix Θ (lags × ordinates) is the product
b δᵀ. It is estimated without that constraint by linear least squares; its first singular pair is
the nearest product (Bai 1998, doi:10.1016/S0005-1098(97)00198-2).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.design import Stretch
from usmbench.identify.dynamics import Dynamics
from usmbench.identify.triangle import triangle

Array = NDArray[np.float64]

_RIDGE = 1e-8  # relative to the largest singular value: products the data do not resolve stay 0
_STABLE = 0.98
_FEW_ROWS = 3_000


def separable_start(
    stretches: Sequence[Stretch], na: int, nb: int, dead_times: Sequence[int]
) -> Dynamics:
    """Return dynamics to start the search from, at the dead time that predicts best.

    Parameters
    ----------
    stretches
        Regressors of each segment.
    na, nb
        Orders of the linear part.
    dead_times
        Dead times to compare, in windows.

    Returns
    -------
    Dynamics
        Stable; without a or with b_0 alone where the data say nothing usable.
    """
    tried = [_at_dead_time(stretches, na, nb, dead) for dead in dead_times]
    return min(tried, key=lambda entry: entry[0])[1]


def _at_dead_time(
    stretches: Sequence[Stretch], na: int, nb: int, dead_time: int
) -> tuple[float, Dynamics]:
    """Mean squared one-step error and dynamics at one dead time."""
    first = max(na, nb + dead_time)
    rows = [s for s in stretches if s.basis.shape[0] > first + na + nb]
    points = sorted({s.point for s in rows})
    left = _FEW_ROWS
    past: list[Array] = []
    speed: list[Array] = []
    n = 0
    for point in points:
        lags, own_past, own_speed = [], [], []
        for s in (s for s in rows if s.point == point):
            size = min(s.basis.shape[0], max(left, first + 1))
            left -= size
            ends = [slice(first - dead_time - k, size - dead_time - k) for k in range(nb + 1)]
            lags.append(np.hstack([s.basis[end] for end in ends]))
            own_past.append(
                np.column_stack(
                    [-s.speed_rad_s[first - i : size - i] for i in range(1, na + 1)]
                    or [np.empty((size - first, 0))]
                )
            )
            own_speed.append(s.speed_rad_s[first:size])
        columns = np.vstack(lags)
        outcomes = np.column_stack([np.vstack(own_past), np.concatenate(own_speed)])
        factor, m = triangle(np.hstack([columns, outcomes])), columns.shape[1]
        u, singular, _ = np.linalg.svd(factor[:m, :m])
        span = u[:, : singular.size][:, singular > _RIDGE * singular[0]]
        factor[:m, m:] -= span @ (span.T @ factor[:m, m:])
        past.append(factor[:, m:-1])
        speed.append(factor[:, -1])
        n += columns.shape[0]
    if not points:
        return np.inf, Dynamics(np.zeros(na), np.zeros(nb), dead_time)
    stacked, target = np.vstack(past), np.concatenate(speed)
    a = np.empty(0)
    if na:
        a = np.asarray(np.linalg.lstsq(stacked, target, rcond=None)[0], dtype=np.float64)
    sse = float(np.sum((target - stacked @ a) ** 2))
    return sse / max(n, 1), Dynamics(_stabilised(a), np.zeros(nb), dead_time)


def _stabilised(a: Array) -> Array:
    """Draw poles at or beyond the unit circle back inside."""
    poles = np.roots(np.r_[1.0, a])
    size = np.abs(poles)
    drawn = np.where(size > _STABLE, poles * _STABLE / np.maximum(size, _STABLE), poles)
    return np.asarray(np.poly(drawn).real[1:], dtype=np.float64)
