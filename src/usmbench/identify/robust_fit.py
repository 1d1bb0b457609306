"""Output-error fits in which neither outliers nor the noisier rows rule."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.design import Stretch
from usmbench.identify.dynamics import Dynamics
from usmbench.identify.output_error import fit_output_error
from usmbench.identify.projected import Projected
from usmbench.identify.row_weights import RowWeights

Array = NDArray[np.float64]

OVER_MEDIAN = 1.4826  # standard deviation over median absolute deviation, of normal noise
_ROUNDS = 4
_CLOSE = 0.1  # squared distance to a minimum, in standard deviations of the estimates
_BISQUARE = 4.685  # 95 % efficiency at the normal distribution (Huber and Ronchetti 2009)
_SAME_SCALE = 0.02  # relative change of the scales below which the weights stand
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
    """

    problem: Projected
    settled_rad_s: float
    changing_rad_s: float

    @property
    def quietest_rad_s(self) -> float:
        """The smaller of both scales."""
        return min(self.settled_rad_s, self.changing_rad_s)


def robust_fit(start: Projected) -> RobustFit:
    """Fit the free run with Tukey's bisquare, iteratively reweighted.

    Windows just after a change of phase have a scale of their own: the moment of the command
    within its window, and dynamics that are none of a linear system, make them noisier.

    Parameters
    ----------
    start
        The problem at parameters to start from, with the weights of residuals like its own.

    Returns
    -------
    RobustFit
        The fit after the last reweighting. The scales are those of its residuals, its weights
        those of one round before.
    """
    problem, kinds = start, residual_scales(start)
    close = _CLOSE / sum(residual.size for residual in start.fit.residual_rad_s)
    for _ in range(_ROUNDS):
        problem = fit_output_error(problem, close)
        before, kinds = kinds, residual_scales(problem)
        if np.allclose(before, kinds, rtol=_SAME_SCALE, atol=0.0):
            break
        problem = problem.reweighted(bisquare_weights(problem, kinds))
    return RobustFit(problem, *kinds)


def residual_scales(problem: Projected) -> tuple[float, float]:
    """Return the standard deviations of what a fit leaves.

    Parameters
    ----------
    problem
        The fit.

    Returns
    -------
    settled, changing
        Away from changes of phase, and just after them; 1 where the model passes through most
        rows exactly and there is no scale to weight by.
    """
    changing = [changing_rows(s.phase_deg, problem.fit.dynamics) for s in problem.stretches]
    kinds = scales(np.concatenate(problem.fit.residual_rad_s), np.concatenate(changing))
    return kinds if min(kinds) > 0.0 else (1.0, 1.0)


def bisquare_weights(problem: Projected, kinds: tuple[float, float]) -> list[RowWeights]:
    """Return the weights that residuals give their rows.

    Parameters
    ----------
    problem
        The fit that left them.
    kinds
        Their standard deviations, as of `residual_scales`.
    """
    weights = []
    for s, residual in zip(problem.stretches, problem.fit.residual_rad_s, strict=True):
        changing = changing_rows(s.phase_deg, problem.fit.dynamics)
        scale = np.where(changing, kinds[1], kinds[0])
        weights.append(RowWeights(scale / min(kinds), bisquare_root(residual / scale)))
    return weights


def counted_alike(stretches: Sequence[Stretch]) -> list[RowWeights]:
    """Return the weights of rows of which nothing is known.

    Parameters
    ----------
    stretches
        The segments.
    """
    return [RowWeights(ones, ones) for ones in (np.ones(s.speed_rad_s.size) for s in stretches)]


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
    return max(OVER_MEDIAN * float(half), float(most) / 1.2816)


def changing_rows(phase_deg: Array, dynamics: Dynamics) -> NDArray[np.bool_]:
    """Return the rows on which a change of phase still acts directly.

    Parameters
    ----------
    phase_deg
        Commanded phase, shape (n,).
    dynamics
        The linear part: its dead time and numerator say how long.
    """
    changed = np.concatenate(([True], phase_deg[1:] != phase_deg[:-1]))
    first, last = dynamics.dead_time_windows, dynamics.dead_time_windows + dynamics.beta.size
    recent = np.zeros(changed.size, dtype=np.bool_)
    for lag in range(first, min(last, changed.size - 1) + 1):
        recent[lag:] |= changed[: changed.size - lag]
    return recent
