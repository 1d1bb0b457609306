"""A start for the search without a guess: linear least squares, with b and δ not yet told apart.

In ``ω(t) = −Σ a_i ω(t−i) + Σ_k Θ_k · B(t−D−k)`` the matrix Θ (lags × ordinates) is the product
b δᵀ. Without that constraint the equation is linear (Bai 1998,
doi:10.1016/S0005-1098(97)00198-2). It gives the poles and the dead time; the search that starts
there keeps to products.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.design import Stretch
from usmbench.identify.dynamics import Dynamics
from usmbench.identify.triangle import triangle
from usmbench.model.linear import poles

Array = NDArray[np.float64]

_RIDGE = 1e-8  # of the regressors' size: products that the data do not resolve stay 0
_STABLE = 0.98
_BEYOND = 2.0  # times the least mean squared error


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
        Dead times to compare, in windows, rising.

    Returns
    -------
    Dynamics
        Stable; without a or with b_0 alone where the data say nothing usable.
    """
    least, best = _at_dead_time(stretches, na, nb, dead_times[0])
    for dead_time in dead_times[1:]:
        error, found = _at_dead_time(stretches, na, nb, dead_time)
        if error > _BEYOND * least:
            break  # longer than the true one: the beginning of every answer is missed
        if error < least:
            least, best = error, found
    return best


def _at_dead_time(
    stretches: Sequence[Stretch], na: int, nb: int, dead_time: int
) -> tuple[float, Dynamics]:
    """Mean squared one-step error and dynamics at one dead time."""
    first = _first_row(na, nb, dead_time)
    usable = [s for s in stretches if s.speed_rad_s.size > first + na + nb]
    beyond, n = [np.empty((0, na + 1))], 0
    for point in sorted({s.point for s in usable}):
        blocks = [_lagged(s, na, nb, dead_time) for s in usable if s.point == point]
        m = blocks[0].shape[1] - na - 1
        ridge = _RIDGE * np.linalg.norm(blocks[0]) * np.eye(m, m + na + 1)
        beyond.append(triangle(ridge, *blocks)[m:, m:])
        n += sum(block.shape[0] for block in blocks)
    if n == 0:
        return np.inf, Dynamics(np.zeros(na), np.zeros(nb), dead_time)
    left = np.vstack(beyond)
    a = np.asarray(np.linalg.lstsq(left[:, :na], left[:, na], rcond=None)[0], dtype=np.float64)
    sse = float(np.sum((left[:, na] - left[:, :na] @ a) ** 2))
    return sse / n, Dynamics(_stabilised(a), np.zeros(nb), dead_time)


def _first_row(na: int, nb: int, dead_time: int) -> int:
    """First row with a whole past; in the very first the motor may still come from elsewhere."""
    return max(1, na, nb + dead_time)


def _lagged(stretch: Stretch, na: int, nb: int, dead_time: int) -> Array:
    """Regressors with a whole past: lags of the basis, of the speed, and the speed itself."""
    first, n = _first_row(na, nb, dead_time), stretch.speed_rad_s.size
    late = range(dead_time, dead_time + nb + 1)
    return np.column_stack(
        [stretch.basis[first - k : n - k] for k in late]
        + [-stretch.speed_rad_s[first - i : n - i] for i in range(1, na + 1)]
        + [stretch.speed_rad_s[first:]]
    )


def _stabilised(a: Array) -> Array:
    """Draw poles at or beyond the unit circle back inside."""
    found = poles(a)
    size = np.abs(found)
    drawn = np.where(size > _STABLE, found * _STABLE / np.maximum(size, _STABLE), found)
    # Of no poles numpy makes a plain number.
    return np.atleast_1d(np.poly(drawn).real)[1:]
