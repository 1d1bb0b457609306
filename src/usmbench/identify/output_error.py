"""Output-error estimation: the free run is fitted, with the curves eliminated.

For fixed dynamics the free-running output is linear in the curves' ordinates δ, so only the few
coefficients of the dynamics are searched (variable projection; Golub and Pereyra 1973,
doi:10.1137/0710036, with Kaufman's Jacobian). The gain is 1 by construction: the numerator is
``(1 + Σa) β`` with ``Σβ = 1``.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.design import Stretch
from usmbench.identify.dynamics import Family
from usmbench.identify.projected import Projected, RowWeights

Array = NDArray[np.float64]

_MAX_STEPS = 50
_TOLERANCE = 1e-6


def fit_output_error(
    stretches: Sequence[Stretch],
    family: Family,
    start: Array,
    weights: Sequence[RowWeights],
    penalties: Sequence[Array],
) -> Projected:
    """Fit dynamics and curves to the free run.

    Parameters
    ----------
    stretches
        Regressors of each segment.
    family
        Where to search.
    start
        Parameters to start from; stable.
    weights
        How much each segment's rows count.
    penalties
        Rows that pull each operating point's δ towards 0, shape (m, d + 1); see
        `usmbench.identify.selection.prior_rows`.

    Returns
    -------
    Projected
        The problem at a minimum of the weighted sum of squares, or where no step lowers it.
    """
    here = Projected(stretches, family, start, weights, penalties)
    damping = 1e-6
    for _ in range(_MAX_STEPS):
        jacobian, residual = here.reduced()
        if jacobian.shape[1] == 0:
            break
        scale = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-300)
        step = _damped_step(jacobian / scale, residual, damping) / scale
        moved = family.moved(here.fit.parameters, step)
        stable = family.dynamics(moved).stable
        there = Projected(stretches, family, moved, weights, penalties) if stable else None
        if there is None or not there.fit.sse < here.fit.sse:
            damping *= 10.0
            if damping > 1e6:
                break
            continue
        gained = here.fit.sse - there.fit.sse
        here, damping = there, max(damping / 10.0, 1e-12)
        if gained <= _TOLERANCE * here.fit.sse:
            break
    return here


def _damped_step(jacobian: Array, residual: Array, damping: float) -> Array:
    """Solve the damped least-squares problem by an orthogonal factorisation."""
    size = jacobian.shape[1]
    stacked = np.vstack([jacobian, np.sqrt(damping) * np.eye(size)])
    step: Array = np.linalg.lstsq(stacked, np.r_[residual, np.zeros(size)], rcond=None)[0]
    return step
