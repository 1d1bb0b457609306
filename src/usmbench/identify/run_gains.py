"""The gain that each run has of its own, taken out before curves are chosen.

A motor is a little faster on one day than on another. Runs visit other phases, at other operating
points: a curve through all of them would follow the runs, not the phase.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, helmert

from usmbench.identify.data import Dataset, FittedRun
from usmbench.identify.projected import Projected
from usmbench.identify.row_weights import times
from usmbench.identify.triangle import triangle

Array = NDArray[np.float64]

_TOLD = 0.01  # share of a run's rows that others have to share
_NOTHING = 1e-12  # (rad/s)²: of runs in which nothing turns
_FAR = 0.05  # that a user has to hear of


def run_gains(problem: Projected, runs: Sequence[int]) -> Array:
    """Estimate by how much each run is faster than all together, as a share.

    Curves, free at every operating point, are estimated beside: of runs that share next to nothing
    nothing is said. On average the runs have no gain of their own, which no row could tell.

    Parameters
    ----------
    problem
        A fit to all runs.
    runs
        Run of each of its stretches.

    Returns
    -------
    Array
        As shares, adding up to 0, shape (R,) up to the last run that has a stretch.
    """
    n_runs = 1 + max(runs)
    apart = helmert(n_runs)  # the mean belongs to the curves
    slopes = [
        np.multiply.outer(stretch.speed_rad_s - residual, apart[:, run])
        for run, stretch, residual in zip(
            runs, problem.stretches, problem.fit.residual_rad_s, strict=True
        )
    ]
    jacobian, residual = problem.off_curves(slopes, pulled=False)
    whole = triangle(*(times(w.root, s) for w, s in zip(problem.weights, slopes, strict=True)))
    power = whole.T @ whole + _NOTHING * np.eye(n_runs - 1)
    # Ways in which gains differ, and the share of each that no curve can follow.
    told, ways = eigh(jacobian.T @ jacobian, power)
    share = np.where(told > _TOLD, 1.0 / np.maximum(told, _TOLD), 0.0)
    gains: Array = apart.T @ (ways @ (share * (ways.T @ (jacobian.T @ residual))))
    return gains


def at_one_gain(data: Dataset, gains: Array) -> Dataset:
    """Return the samples that the runs would be without a gain of their own.

    Parameters
    ----------
    data
        The samples.
    gains
        As `run_gains` returns them.
    """
    segments = [replace(s, speed_rad_s=s.speed_rad_s / (1.0 + gains[s.run])) for s in data.segments]
    return replace(data, segments=tuple(segments))


def far_off(runs: Sequence[FittedRun], gains: Array) -> list[str]:
    """Warn of runs that are faster or slower than another day makes them.

    Parameters
    ----------
    runs
        The runs.
    gains
        As `run_gains` returns them.
    """
    return [
        f"{run.name}: {100.0 * abs(gain):.0f} % {'faster' if gain > 0.0 else 'slower'} than the "
        "runs on average; is it the same motor, supply and load?"
        for run, gain in zip(runs, gains.tolist(), strict=False)
        if abs(gain) > _FAR
    ]
