"""The dynamics alone, fitted to the rows near changes of phase, with the curves as they are."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from usmbench.identify.design import Stretch
from usmbench.identify.dynamics import Parametrised
from usmbench.identify.polish import Polished
from usmbench.identify.robust_fit import changing_rows
from usmbench.model.linear import free_run, memory_windows
from usmbench.runs.dwells import dwell_begin

Array = NDArray[np.float64]

# Far beyond the memory, and few enough that short stretches have both halves; there and back.
_BLOCK_ROWS, _BLOCK_DWELLS = 25, 2
_FORGOTTEN = 1e-6


@dataclass(frozen=True, slots=True)
class Course:
    """Rows of a stretch within the memory of a change of phase; between them the motor is settled.

    Parameters
    ----------
    settled_rad_s
        The static curve's output, shape (n,).
    speed_rad_s
        Measured speed, shape (n,).
    changing
        Where a change still acts directly, shape (n,).
    half
        Which half of the blocks a row belongs to; -1 where the unknown start still counts.
    """

    settled_rad_s: Array
    speed_rad_s: Array
    changing: NDArray[np.bool_]
    half: NDArray[np.int64]

    def beginning(self, share: float) -> "Course":
        """Return a share of the rows.

        Parameters
        ----------
        share
            From 0 to 1.
        """
        rows = slice(0, math.ceil(share * self.half.size))
        return Course(
            self.settled_rad_s[rows],
            self.speed_rad_s[rows],
            self.changing[rows],
            self.half[rows],
        )


def courses_of(stretches: Sequence[Stretch], found: Polished) -> list[Course]:
    """Return the rows from which the dynamics can be told.

    Parameters
    ----------
    stretches
        Regressors of each segment.
    found
        Curves, and the dynamics that say how long a change is remembered.
    """
    courses = []
    memory = memory_windows(found.dynamics.linear_part(None), _FORGOTTEN)
    for stretch in stretches:
        rows = np.arange(stretch.speed_rad_s.size)
        kept = rows - dwell_begin(stretch.phase_deg) <= memory
        half = np.where(rows > memory, _halves(stretch.phase_deg), -1)
        settled_rad_s = stretch.basis[kept] @ found.delta[stretch.point]
        changing = changing_rows(stretch.phase_deg, found.dynamics)
        courses.append(Course(settled_rad_s, stretch.speed_rad_s[kept], changing[kept], half[kept]))
    return courses


def _halves(phase_deg: Array) -> NDArray[np.int64]:
    """Return which half of the blocks each row belongs to; a block is some whole dwells.

    Blocks of rows would put every change of phase into one half where two of them are a dwell.
    """
    changed = np.diff(phase_deg, prepend=phase_deg[:1]) != 0.0
    dwell_rows = changed.size / (1 + np.count_nonzero(changed))
    dwells = max(_BLOCK_DWELLS, math.ceil(_BLOCK_ROWS / dwell_rows))
    return np.asarray(np.cumsum(changed) // dwells % 2)


def scaled_residual(
    courses: Sequence[Course],
    family: Parametrised,
    parameters: Array,
    scale_rad_s: tuple[float, float],
    halves: tuple[int, ...],
    *,
    changing: bool = False,
) -> Array:
    """Return measured minus free-running speed over its standard deviation.

    Parameters
    ----------
    courses
        The rows.
    family, parameters
        The dynamics.
    scale_rad_s
        Standard deviation away from changes of phase, and just after them.
    halves
        Halves of the blocks to return.
    changing
        Whether to return no rows but those just after a change.
    """
    linear = family.dynamics(parameters).linear_part(1.0)
    left = []
    for c in courses:
        residual = c.speed_rad_s - free_run(linear, c.settled_rad_s)
        rows = np.isin(c.half, halves) & (c.changing | (not changing))
        left.append((residual / np.where(c.changing, scale_rad_s[1], scale_rad_s[0]))[rows])
    return np.concatenate(left)


def fitted_dynamics(
    courses: Sequence[Course],
    family: Parametrised,
    start: Array,
    scale_rad_s: tuple[float, float],
    halves: tuple[int, ...] = (0, 1),
) -> Array:
    """Return the parameters of the dynamics that suit some halves of the blocks best.

    Parameters
    ----------
    courses
        The rows.
    family
        Where to search.
    start
        Parameters to start from.
    scale_rad_s, halves
        As in `scaled_residual`.
    """
    still = np.zeros(start.size)

    def residual(parameters: Array) -> Array:
        kept = family.moved(parameters, still)
        return scaled_residual(courses, family, kept, scale_rad_s, halves)

    best = least_squares(residual, start, loss="soft_l1", x_scale=0.1, xtol=1e-6, ftol=1e-6)
    return family.moved(best.x, still)
