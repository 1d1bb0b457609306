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
        Which half of the dwells a row belongs to; -1 where the unknown start still counts.
    step_rad_s
        Change of the static curve's output at a row, shape (n,).
    """

    settled_rad_s: Array
    speed_rad_s: Array
    changing: NDArray[np.bool_]
    half: NDArray[np.int64]
    step_rad_s: Array

    def beginning(self, share: float) -> "Course":
        """Return a share of the rows.

        Parameters
        ----------
        share
            From 0 to 1.
        """
        return self.at(slice(0, math.ceil(share * self.half.size)))

    def at(self, rows: slice | NDArray[np.bool_]) -> "Course":
        """Return some of the rows.

        Parameters
        ----------
        rows
            Which.
        """
        return Course(
            self.settled_rad_s[rows],
            self.speed_rad_s[rows],
            self.changing[rows],
            self.half[rows],
            self.step_rad_s[rows],
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
    settled = [s.basis @ found.delta[s.point] for s in stretches]
    steps = [np.diff(rad_s, prepend=rad_s[:1]) for rad_s in settled]
    halves = _halves([s.phase_deg for s in stretches], steps)
    for s, settled_rad_s, step_rad_s, half in zip(stretches, settled, steps, halves, strict=True):
        rows = np.arange(s.speed_rad_s.size)
        kept = rows - dwell_begin(s.phase_deg) <= memory
        changing = changing_rows(s.phase_deg, found.dynamics)
        own = np.where(rows > memory, half, -1)
        whole = Course(settled_rad_s, s.speed_rad_s, changing, own, step_rad_s)
        courses.append(whole.at(kept))
    return courses


def _halves(phases_deg: Sequence[Array], steps_rad_s: Sequence[Array]) -> list[NDArray[np.int64]]:
    """Return which half of the dwells each row belongs to: both begin with steps of all sizes."""
    changed = [np.diff(p_deg, prepend=np.nan) != 0.0 for p_deg in phases_deg]
    sizes = np.abs(np.concatenate([step[c] for step, c in zip(steps_rad_s, changed, strict=True)]))
    by_size = np.argsort(-sizes, kind="stable")
    half_of_dwell = np.empty(sizes.size, dtype=np.int64)
    half_of_dwell[by_size] = (np.arange(sizes.size) + 1) // 2 % 2  # the largest, two, two ...
    dwell = np.cumsum(np.concatenate(changed)) - 1
    ends = np.cumsum([c.size for c in changed])[:-1]
    return np.split(half_of_dwell[dwell], ends)


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
        Halves of the dwells to return.
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
    """Return the parameters of the dynamics that suit some halves of the dwells best.

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
