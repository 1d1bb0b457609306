"""Output-error estimation: the free run is fitted, with the curves eliminated.

For fixed dynamics the free-running output is linear in the curves' ordinates δ, so only the few
coefficients of the dynamics are searched (variable projection; Golub and Pereyra 1973,
doi:10.1137/0710036, with Kaufman's Jacobian). The gain is 1 by construction: the numerator is
``(1 + Σa) β`` with ``Σβ = 1``.
"""

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.projected import Projected

Array = NDArray[np.float64]

_MAX_STEPS = 50
_MOST_DAMPING = 1e6


def fit_output_error(start: Projected, tolerance: float) -> Projected:
    """Fit dynamics and curves to the free run.

    Parameters
    ----------
    start
        The problem at stable dynamics to start from.
    tolerance
        Share of the sum of squares; a step that promises to gain less is not made.

    Returns
    -------
    Projected
        The problem at a minimum of the weighted sum of squares, or where no step lowers it.
    """
    here, family, damping = start, start.family, 1e-6
    jacobian, residual = here.reduced()
    for _ in range(_MAX_STEPS):
        step = _damped_step(jacobian, residual, damping)
        moved = family.moved(here.fit.parameters, step)
        left = residual - jacobian @ step
        promised = float(residual @ residual - left @ left)
        if promised <= tolerance * here.fit.sse or damping > _MOST_DAMPING:
            break
        there = here.at(moved) if family.dynamics(moved).stable else None
        if there is None or not there.fit.sse < here.fit.sse:
            damping *= 10.0
            continue
        here, damping = there, max(damping / 10.0, 1e-12)
        jacobian, residual = here.reduced()
    return here


def _damped_step(jacobian: Array, residual: Array, damping: float) -> Array:
    """Solve the damped least-squares problem by an orthogonal factorisation."""
    scale = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-300)
    stacked = np.vstack([jacobian / scale, np.sqrt(damping) * np.eye(scale.size)])
    target = np.concatenate((residual, np.zeros(scale.size)))
    step: Array = np.linalg.lstsq(stacked, target, rcond=None)[0] / scale
    return step
