"""Rows of the whitened residual weighed by how far out they are."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.noise.rotor_states import turns
from usmbench.diagnose.residual.problem import Problem
from usmbench.identify.robust_fit import OVER_MEDIAN

Array = NDArray[np.float64]

_HUBER = 2.5
_FEWEST = 50  # rows of a rotor that turns


def huber_weights(problem: Problem, left_rad_s: Sequence[Array]) -> list[Array]:
    """Return the weights of the rows of each stretch: noise near the dead zone has heavy tails.

    By Huber (1964, doi:10.1214/aoms/1177703732), against the median of the rows that count.

    Parameters
    ----------
    problem
        The problem, its rows not weighed.
    left_rad_s
        What is left of each stretch, shape (N,).
    """
    carried = problem.carried(left_rad_s)
    white, scale = np.abs(carried[: problem.n_rows]), robust_spread(problem, carried)
    kept = np.sqrt(np.minimum(1.0, _HUBER * scale / np.maximum(white, 1e-12)))
    weights, at = [], 0
    for valid in problem.valid:
        weight = np.ones(valid.size)
        n = int(np.count_nonzero(valid))
        weight[valid] = kept[at : at + n]
        weights.append(weight)
        at += n
    return weights


def robust_spread(problem: Problem, carried: Array) -> float:
    """Return the standard deviation of whitened rows about 0, by their median; at least 1.

    A rotor that stands may have no noise at all: those rows do not tell, where others do.

    Parameters
    ----------
    problem
        The problem.
    carried
        A carried residual, its rows first, shape (M,).
    """
    white = np.abs(carried[: problem.n_rows])
    rows = zip(problem.stretches, problem.valid, strict=True)
    turning = np.concatenate([turns(s)[valid] for s, valid in rows])
    telling = white[turning] if np.count_nonzero(turning) >= _FEWEST else white
    return max(OVER_MEDIAN * float(np.median(telling)), 1.0)
