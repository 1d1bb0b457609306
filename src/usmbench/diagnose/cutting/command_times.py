"""Commands that keep their own time: phases that change at any moment within a window.

Where a generator runs by a clock of its own, each dwell takes as long as the last, and no whole
number of windows. Whether a phase came early or late in its window then repeats every few dwells,
which looks like a shaft that swings.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch

Array = NDArray[np.float64]

# Of 12 lengths that chance draws from two neighbours, 5 % are those of one even interval.
_DWELLS, _SHARE, _FEWEST = 12, 0.5, 12
_ANY_MOMENT = 12.0**-0.5  # of a window: standard deviation
_SCATTERS = (0.5, 2.0)  # times that; steps that noise covers seem to scatter by more
_AT_ONCE, _LARGE = 3, 0.5  # windows in which a step shows; of the largest step
_REPEATS = 30.0  # times as unsure as one such moment: over a run, what repeats adds up


def keeps_own_time(stretch: Stretch) -> bool:
    """Return whether the phase changes at even intervals and any moment within a window.

    Parameters
    ----------
    stretch
        The stretch.
    """
    changes = np.flatnonzero(stretch.lag == 0)[1:]  # the first row is the beginning
    if not between_windows(changes) or np.median(np.diff(changes)) < _AT_ONCE:
        return False
    low, high = _SCATTERS
    return low * _ANY_MOMENT < _moment_windows(stretch, changes) < high * _ANY_MOMENT


def between_windows(changes: NDArray[np.int64]) -> bool:
    """Return whether changes come at even intervals that are no whole number of windows.

    Parameters
    ----------
    changes
        Numbers of the windows at whose end a phase has changed, rising, shape (K,).
    """
    if changes.size <= _DWELLS:
        return False
    rows = np.lib.stride_tricks.sliding_window_view(changes, _DWELLS + 1)
    mixed = np.ptp(np.diff(rows, axis=1), axis=1) == 1
    # An interval D and its first change put each of them into its row: |r_j − r_i − (j − i) D| < 1.
    least, most = np.full(len(rows), -np.inf), np.full(len(rows), np.inf)
    for apart in range(1, _DWELLS + 1):
        between = rows[:, apart:] - rows[:, :-apart]
        least = np.maximum(least, (between.max(axis=1) - 1.0) / apart)
        most = np.minimum(most, (between.min(axis=1) + 1.0) / apart)
    even = np.count_nonzero(mixed & (least < most))
    return bool(even >= max(_FEWEST, _SHARE * np.count_nonzero(mixed)))


def _moment_windows(stretch: Stretch, changes: NDArray[np.int64]) -> float:
    """Return the deviation of the moments at which large steps show, in windows.

    A step that comes later by a share of a window lacks as much of its height, all in all.
    """
    changes = changes[changes <= stretch.context.n - _AT_ONCE]
    step_rad_s = stretch.step_rad_s[changes]
    large = np.abs(step_rad_s) > _LARGE * np.max(np.abs(step_rad_s), initial=1e-12)
    lacks = np.convolve(stretch.residual_rad_s, np.ones(_AT_ONCE))[_AT_ONCE - 1 :][changes]
    late = -lacks[large] / step_rad_s[large]
    return float(np.std(late)) if late.size else 0.0


def any_moment_s(stretches: Sequence[Stretch]) -> float:
    """Return by how much commands of runs may be late: a window where any keeps its own time, or 0.

    Parameters
    ----------
    stretches
        The runs.
    """
    own = [s.context.window_s for s in stretches if keeps_own_time(s)]
    return max(own, default=0.0)


def at_unknown_moments(stretches: Sequence[Stretch], late_s: float) -> list[Stretch]:
    """Say of each row how far nobody knows at which moment of a window a command acted.

    Parameters
    ----------
    stretches
        The runs.
    late_s
        By how much commands may be late; less than a window is known well enough.
    """
    return [
        replace(s, moment_rad_s=_unsure(s.simulated_rad_s)) if late_s >= s.context.window_s else s
        for s in stretches
    ]


def at_moments_of(stretches: Sequence[Stretch], changes: Sequence[Array]) -> list[Stretch]:
    """Say the same where a cause is likely, which may move the moments.

    Parameters
    ----------
    stretches
        The runs, marked.
    changes
        What the cause changes of the speed of each, in rad/s, shape (N,).
    """
    return [
        replace(s, moment_rad_s=np.hypot(s.moment_rad_s, _unsure(s.simulated_rad_s + change)))
        if np.any(s.moment_rad_s)
        else s
        for s, change in zip(stretches, changes, strict=True)
    ]


def _unsure(speed_rad_s: Array) -> Array:
    """Return how far a speed may be off for a command at any moment of its window, shape (N,)."""
    unsure: Array = _REPEATS * _ANY_MOMENT * np.abs(np.diff(speed_rad_s, prepend=speed_rad_s[:1]))
    return unsure


def unknown_moments(stretches: Sequence[Stretch]) -> list[str]:
    """Say which runs' commands act at unknown moments.

    Parameters
    ----------
    stretches
        The runs, marked.

    Returns
    -------
    list of str
        One warning a run.
    """
    names = dict.fromkeys(s.name for s in stretches if np.any(s.moment_rad_s))
    return [
        f"{name}: the phase changes at moments within the windows, here or in the model's runs, so "
        "the windows right after it tell little; let dwells last a whole number of windows"
        for name in names
    ]
