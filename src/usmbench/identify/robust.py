"""Output-error fits in which neither outliers nor the noisier rows rule."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.design import Stretch
from usmbench.identify.dynamics import Dynamics, Family
from usmbench.identify.output_error import fit_output_error
from usmbench.identify.projected import Projected, RowWeights

Array = NDArray[np.float64]

_ROUNDS = 4
_BISQUARE = 4.685  # 95 % efficiency at the normal distribution (Huber and Ronchetti 2009)
_SAME_SCALE = 0.005  # relative change of the scales below which the weights stand
_FEWEST = 8  # rows of a kind that tell its scale


@dataclass(frozen=True, slots=True)
class RobustFit:
    """A fit, and the scales that its weights came from.

    Parameters
    ----------
    problem
        The problem at the estimate, with its weights.
    settled_rad_s, changing_rad_s
        Standard deviation of the residual away from changes of phase, and just after them.
    n
        Rows of the fit.
    """

    problem: Projected
    settled_rad_s: float
    changing_rad_s: float
    n: int

    @property
    def quietest_rad_s(self) -> float:
        """The smaller of both scales."""
        return min(self.settled_rad_s, self.changing_rad_s)


def robust_fit(
    stretches: Sequence[Stretch], family: Family, start: Array, priors: Sequence[Array]
) -> RobustFit:
    """Fit the free run with Tukey's bisquare, iteratively reweighted.

    Windows just after a change of phase have a scale of their own: the moment of the command
    within its window, and dynamics that are none of a linear system, make them noisier.

    Parameters
    ----------
    stretches
        Regressors of each segment.
    family
        Where to search the dynamics.
    start
        Parameters to start from.
    priors
        Rows of prior knowledge of each operating point's curve.

    Returns
    -------
    RobustFit
        The fit after the last reweighting.
    """
    changing = [changing_rows(s.phase_deg, family.dynamics(start)) for s in stretches]
    even = [np.ones(s.speed_rad_s.size) for s in stretches]
    weights = [RowWeights(ones, ones) for ones in even]
    problem = fit_output_error(stretches, family, start, weights, priors)
    change = np.concatenate(changing)
    settled = moving = 1.0
    for _ in range(_ROUNDS):
        residual = np.concatenate(problem.fit.residual_rad_s)
        before = settled, moving
        settled, moving = scales(residual, change)
        if settled == 0.0 or moving == 0.0:
            # The model passes through most rows exactly: there is no scale to weight by.
            settled = moving = 1.0
            break
        weights = []
        for r, c in zip(problem.fit.residual_rad_s, changing, strict=True):
            scale = np.where(c, moving, settled)
            weights.append(RowWeights(scale / min(settled, moving), bisquare_root(r / scale)))
        problem = fit_output_error(stretches, family, problem.fit.parameters, weights, priors)
        if np.allclose(before, (settled, moving), rtol=_SAME_SCALE, atol=0.0):
            break
    return RobustFit(problem, settled, moving, change.size)


def bisquare_root(residual: Array) -> Array:
    """Return the square root of Tukey's bisquare weight.

    Parameters
    ----------
    residual
        Residuals over their standard deviation, shape (n,).
    """
    return np.clip(1.0 - (residual / _BISQUARE) ** 2, 0.0, 1.0)


def scales(residual: Array, changing: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the standard deviations away from changes of phase, and just after them.

    Parameters
    ----------
    residual
        Residuals, shape (n,).
    changing
        Which of them lie just after a change.
    """
    settled, moving = (_scale(residual[kind], residual) for kind in (~changing, changing))
    return settled, moving


def _scale(kind: Array, all_rows: Array) -> float:
    """Return the standard deviation of one kind of rows by quantiles; of all where it has few.

    The median alone is 0 where the motor stands still for half of the record.
    """
    rows = kind if kind.size >= _FEWEST else all_rows
    half, most = np.quantile(np.abs(rows), [0.5, 0.8]).tolist()
    return max(1.4826 * float(half), float(most) / 1.2816)


def changing_rows(phase_deg: Array, dynamics: Dynamics) -> NDArray[np.bool_]:
    """Return the rows on which a change of phase still acts directly.

    Parameters
    ----------
    phase_deg
        Commanded phase, shape (n,).
    dynamics
        The linear part: its dead time and numerator say how long.
    """
    changed = np.r_[True, phase_deg[1:] != phase_deg[:-1]]
    first, last = dynamics.dead_time_windows, dynamics.dead_time_windows + dynamics.beta.size
    recent = np.zeros(changed.size, dtype=np.bool_)
    for lag in range(first, min(last, changed.size - 1) + 1):
        recent[lag:] |= changed[: changed.size - lag]
    return recent
