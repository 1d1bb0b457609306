"""How large a hidden effect is."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from benchmarks.campaign_runs import COUNT_RAD_S
from usmbench.identify.robust_fit import OVER_MEDIAN

Array = NDArray[np.float64]

_FAR: Final = 6.0  # spreads of the bulk
_HANDFUL: Final = 10  # windows


def noise_of(healthy: Array) -> Array:
    """Return the noise of runs that ought to be the same, without the wander of their gain.

    Parameters
    ----------
    healthy
        The speeds in rad/s, shape (D, N).

    Returns
    -------
    noise
        In rad/s, as large as that of one run, shape (D, N).
    """
    n_days, mean = len(healthy), healthy.mean(axis=0)
    apart = (healthy - mean) * np.sqrt(n_days / (n_days - 1.0))
    noise: Array = apart - np.outer(apart @ mean, mean) / (mean @ mean)
    return noise


def not_far_out(error: Array) -> NDArray[np.bool_]:
    """Return the windows whose error is not far beyond the bulk, shape (N,).

    Parameters
    ----------
    error
        The error in rad/s, shape (N,).
    """
    spread_rad_s = OVER_MEDIAN * float(np.median(np.abs(error)))
    near: NDArray[np.bool_] = np.abs(error) < _FAR * spread_rad_s
    return near


def well_counted(speeds_rad_s: Array) -> NDArray[np.bool_]:
    """Return the windows in which the shaft goes on standing, or turning by two counts and more.

    In others it hangs on the angle of the disc alone which of two windows a count falls into.

    Parameters
    ----------
    speeds_rad_s
        The speeds of some runs, shape (D, N).
    """
    size = np.abs(speeds_rad_s)
    stands, turns = np.all(size == 0.0, axis=0), np.all(size > 2.0 * COUNT_RAD_S, axis=0)
    well: NDArray[np.bool_] = stands | turns
    well[1:] = (stands[1:] & stands[:-1]) | (turns[1:] & turns[:-1])
    return well


def square_of(seen: Array, *, by_chance: bool = False) -> float:
    """Return the square of what several sightings show: the mean of eᵢ·eⱼ over all i ≠ j.

    What is another each day is left out. In the square of the sightings' unit.

    Parameters
    ----------
    seen
        Shape (D, N).
    by_chance
        What is seen strikes other windows each day, and does not move the shaft: the mean of eᵢ·eᵢ.
    """
    alike = seen @ seen.T
    own = float(np.trace(alike))
    if by_chance:
        return own / len(seen)
    return max(float(np.sum(alike)) - own, 0.0) / (len(seen) * (len(seen) - 1))


def strength_of(
    effects: Array, wanders: Array, noise_rad_s: float, *, by_chance: bool = False
) -> float:
    """Root of an effect's deviance a window: its rms over the noise's, where nothing wanders.

    Of an effect that looks like another gain, no run tells more than how many wanders it amounts
    to; and what shows in a handful of windows only has no name, however large it is there.

    Parameters
    ----------
    effects
        What is hidden, in rad/s, as some days show it, shape (D, N).
    wanders
        What a standard deviation of all that wanders from run to run changes, shape (N, K).
    noise_rad_s
        Root mean square of the noise.
    by_chance
        See `square_of`.
    """
    usual = np.argsort(np.mean(effects**2, axis=0))[:-_HANDFUL]
    hidden, ways = effects[:, usual].T / noise_rad_s, wanders[usual] / noise_rad_s
    beta = np.linalg.solve(ways.T @ ways + np.eye(ways.shape[1]), ways.T @ hidden)
    whole = np.concatenate([hidden - ways @ beta, beta]).T
    return float(np.sqrt(square_of(whole, by_chance=by_chance) / usual.size))
