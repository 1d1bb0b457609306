"""What an extension gains on blocks of the runs that its fit has not seen."""

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

    @property
    def left_over(self) -> float:
        """What the extension leaves, over the noise."""
        return self.rmse_extended_rad_s / max(self.noise_floor_rad_s, 1e-12)


def held_out_gain(problem: Problem, foretold: Sequence[Array], struck: Sequence[Mask] = ()) -> Gain:
    """Score effects on blocks that their values were not fitted on, beside the model as given.

    Rows that stand alone count neither before nor after: whether a motor starts in one window or
    in the next may hang on nothing at all.

    Parameters
    ----------
    problem
        The problem.
    foretold
        What the effects change, as from `foretold_rad_s`.
    struck
        Rows of each stretch that stand alone and that the extension has a name for, shape (N,)
        each; then the model as given has to answer for all that do. Empty for no such name.
    """
    held = [s.residual_rad_s - f for s, f in zip(problem.stretches, foretold, strict=True)]
    sums = []
    alone = struck or [np.zeros_like(mask) for mask in problem.masks]
    masks = [mask & ~a for mask, a in zip(problem.masks, alone, strict=True)]
    for stretch, after, mask in zip(problem.stretches, held, masks, strict=True):
        block = block_of(stretch)
        level = problem.noise.level_rad_s(replace(stretch, moment_rad_s=0.0))
        scored = stretch.use & mask
        plain = stretch.use if struck else scored
        sums.append(
            np.array(
                [
                    np.bincount(block[rows], weights=values[rows], minlength=BLOCKS)
                    for rows, values in (
                        (plain, stretch.residual_rad_s**2),
                        (scored, after**2),
                        (plain, level**2),
                        (plain, np.ones(plain.size)),
                        (scored, np.ones(plain.size)),
                    )
                ]
            )
        )
    return gain_of_blocks(np.concatenate(sums, axis=1))


def gain_of_blocks(table: Array) -> Gain:
    """Return the scores of blocks, and how far chance may move them.

    Parameters
    ----------
    table
        Sums of squares of the residual before, after, and of the noise, and numbers of rows before
        and after; one column a block, shape (5, K).
    """
    table = table[:, table[3] > 0]
    ms, value = _shares(table)
    draw = np.random.default_rng(_SEED)
    n = table.shape[1]
    values = [_shares(table[:, draw.integers(0, n, n)])[1] for _ in range(_DRAWS)]
    low, high = (float(q) for q in np.quantile(values, [0.025, 0.975]))
    before, after_rms, floor = (float(root) for root in np.sqrt(ms))
    return Gain(before, after_rms, floor, value, min(low, value), max(high, value))


def _shares(table: Array) -> tuple[Array, float]:
    """Mean squares (before, after, noise) and the gain."""
    total = table.sum(axis=1)
    n, n_after = max(total[3], 1.0), max(total[4], 1.0)
    ms = np.array([total[0] / n, total[1] / n_after, total[2] / n])
    floor = min(ms[2], ms[1])
    above = ms[0] - floor
    gain = (ms[0] - ms[1]) / above if above > 1e-12 else 0.0
    return np.array([ms[0], ms[1], floor]), float(np.clip(gain, 0.0, 1.0))
