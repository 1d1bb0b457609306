"""What an extension gains on blocks of the runs that its fit has not seen."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.fitting import Fit, refine
from usmbench.diagnose.problem import Problem
from usmbench.diagnose.stretches import Mask

Array = NDArray[np.float64]

_FOLDS = 4
_BLOCKS = 12
_DRAWS = 400
_SEED = 1


@dataclass(frozen=True, slots=True)
class Gain:
    """Held-out, free-running scores.

    Parameters
    ----------
    rmse_simulation_rad_s, rmse_extended_rad_s, noise_floor_rad_s
        Root mean squares of the residual before and after, and of the noise.
    gain, low, high
        Share of the mean square above the noise floor that the extension removes, with its 95 %
        interval by drawing blocks anew.
    """

    rmse_simulation_rad_s: float
    rmse_extended_rad_s: float
    noise_floor_rad_s: float
    gain: float
    low: float
    high: float


def held_out_gain(
    problem: Problem, fit: Fit, gap: int, after_masks: Sequence[Mask] | None = None
) -> Gain:
    """Score effects on blocks that their values were not fitted on, beside the model as given.

    Parameters
    ----------
    problem
        The problem.
    fit
        The effects at their values on all rows; none scores the model against itself.
    gap
        Windows left out of the fit beside the blocks that are held out.
    after_masks
        Rows on which the extension is scored, where it calls the others false counts; None for
        every row in use.
    """
    sums = []
    held = _held_out_residual(problem, fit, gap)
    masks = [s.use for s in problem.stretches] if after_masks is None else after_masks
    parts = zip(problem.stretches, held, masks, _blocks(problem), strict=True)
    for stretch, after, mask, block in parts:
        use = stretch.use
        scored = use & mask
        sums.append(
            np.array(
                [
                    np.bincount(block[rows], weights=values[rows], minlength=_BLOCKS)
                    for rows, values in (
                        (use, stretch.residual_rad_s**2),
                        (scored, after**2),
                        (use, problem.noise.level_rad_s(stretch) ** 2),
                        (use, np.ones(use.size)),
                        (scored, np.ones(use.size)),
                    )
                ]
            )
        )
    table = np.concatenate(sums, axis=1)
    table = table[:, table[3] > 0]
    ms, value = _shares(table)
    draw = np.random.default_rng(_SEED)
    n = table.shape[1]
    values = [_shares(table[:, draw.integers(0, n, n)])[1] for _ in range(_DRAWS)]
    low, high = (float(q) for q in np.quantile(values, [0.025, 0.975]))
    before, after_rms, floor = (float(root) for root in np.sqrt(ms))
    return Gain(before, after_rms, floor, value, min(low, value), max(high, value))


def _held_out_residual(problem: Problem, fit: Fit, gap: int) -> list[Array]:
    """Residual with effects whose values come from the other blocks."""
    held = [s.residual_rad_s for s in problem.stretches]
    if not fit.effects:
        return held
    blocks = _blocks(problem)
    for fold in range(_FOLDS):
        masks = [
            mask & ~_widened(block % _FOLDS == fold, gap)
            for mask, block in zip(problem.masks, blocks, strict=True)
        ]
        refit = refine(problem.with_masks(masks), fit)
        for k, change in enumerate(problem.change_rad_s(refit.effects)):
            rows = blocks[k] % _FOLDS == fold
            held[k][rows] -= change[rows]
    return held


def _shares(table: Array) -> tuple[Array, float]:
    """Mean squares (before, after, noise) and the gain."""
    total = table.sum(axis=1)
    n, n_after = max(total[3], 1.0), max(total[4], 1.0)
    ms = np.array([total[0] / n, total[1] / n_after, total[2] / n])
    floor = min(ms[2], ms[1])
    above = ms[0] - floor
    gain = (ms[0] - ms[1]) / above if above > 1e-12 else 0.0
    return np.array([ms[0], ms[1], floor]), float(np.clip(gain, 0.0, 1.0))


def _blocks(problem: Problem) -> list[NDArray[np.int64]]:
    """Return the number of each row's contiguous block."""
    return [np.arange(s.context.n) * _BLOCKS // s.context.n for s in problem.stretches]


def _widened(rows: Mask, gap: int) -> Mask:
    """Add the rows within a gap of those that are set."""
    reach = np.convolve(rows.astype(np.float64), np.ones(2 * gap + 1), mode="full")
    wide: Mask = reach[gap : gap + rows.size] > 0.5
    return wide
