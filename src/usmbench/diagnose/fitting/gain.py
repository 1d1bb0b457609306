"""What an extension gains on blocks of the runs that its fit has not seen.

It is measured above the noise of a window far from steps (docs/decisions/0010).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask
from usmbench.diagnose.fitting.blocks import BLOCKS, block_of
from usmbench.diagnose.residual.problem import Problem

Array = NDArray[np.float64]

_DRAWS = 400
_SEED = 1
_FLOOR_OFF = 0.1  # share by which the noise's mean square may be off: as in naming/found.py


@dataclass(frozen=True, slots=True)
class Gain:
    """Held-out, free-running scores.

    Parameters
    ----------
    rmse_simulation_rad_s, rmse_extended_rad_s, noise_floor_rad_s
        Root mean squares of the residual before and after, and of the noise of windows far from
        steps.
    gain, low, high
        Share of the mean square above the noise floor that the extension removes, with its 95 %
        interval by drawing blocks anew, and the floor as far off as it may be.
    """

    rmse_simulation_rad_s: float
    rmse_extended_rad_s: float
    noise_floor_rad_s: float
    gain: float
    low: float
    high: float


def held_out_gain(problem: Problem, foretold: Sequence[Array], *, alone: bool = False) -> Gain:
    """Score effects on blocks that their values were not fitted on, beside the model as given.

    Parameters
    ----------
    problem
        The problem.
    foretold
        What the effects change, as from `foretold_rad_s`.
    alone
        Whether rows that stand alone count. Where no cause has a name for them they do not:
        whether a motor starts in one window or in the next may hang on nothing at all.
    """
    sums = []
    parts = zip(problem.stretches, foretold, _scored(problem, alone=alone), strict=True)
    for stretch, change, rows in parts:
        calm, plain = problem.noise.calm_rad_s(stretch), stretch.residual_rad_s
        squares = (plain**2, (plain - change) ** 2, calm**2, np.ones(rows.size))
        block = block_of(stretch)[rows]
        sums.append([np.bincount(block, weights=v[rows], minlength=BLOCKS) for v in squares])
    return gain_of_blocks(np.concatenate(sums, axis=1))


def left_over(problem: Problem, foretold: Sequence[Array], *, alone: bool = False) -> float:
    """Return the rms of what effects leave, over that which the model's own runs show there.

    Parameters
    ----------
    problem, foretold, alone
        As in `held_out_gain`.
    """
    left, usual = 0.0, 0.0
    parts = zip(problem.stretches, foretold, _scored(problem, alone=alone), strict=True)
    for stretch, change, rows in parts:
        level = problem.noise.level_rad_s(replace(stretch, moment_rad_s=0.0))
        left += float(np.sum((stretch.residual_rad_s - change)[rows] ** 2))
        usual += float(np.sum(level[rows] ** 2))
    return float(np.sqrt(left / max(usual, 1e-24)))


def _scored(problem: Problem, *, alone: bool) -> list[Mask]:
    """Rows of each stretch that count, with those that stand alone or without."""
    if alone:
        return [s.use for s in problem.stretches]
    return [s.use & mask for s, mask in zip(problem.stretches, problem.masks, strict=True)]


def gain_of_blocks(table: Array) -> Gain:
    """Return the scores of blocks, and how far chance may move them.

    Parameters
    ----------
    table
        Sums of squares of the residual before, after, and of the noise, and numbers of rows; one
        column a block, shape (4, K).
    """
    table = table[:, table[3] > 0]
    ms, value = _shares(table)
    draw = np.random.default_rng(_SEED)
    n = table.shape[1]
    off = np.ones((_DRAWS, 4, 1))
    off[:, 2, 0] += _FLOOR_OFF * draw.standard_normal(_DRAWS)
    values = [_shares(table[:, draw.integers(0, n, n)] * times)[1] for times in off]
    low, high = (float(q) for q in np.quantile(values, [0.025, 0.975]))
    before, after_rms, floor = (float(root) for root in np.sqrt(ms))
    return Gain(before, after_rms, floor, value, min(low, value), max(high, value))


def _shares(table: Array) -> tuple[Array, float]:
    """Mean squares (before, after, noise) and the gain."""
    total = table.sum(axis=1)
    ms = total[:3] / max(total[3], 1.0)
    floor = min(ms[2], ms[1])
    above = ms[0] - floor
    gain = (ms[0] - ms[1]) / above if above > 1e-12 else 0.0
    return np.array([ms[0], ms[1], floor]), float(np.clip(gain, 0.0, 1.0))
