"""How large a hidden effect is, and in which windows that can be said."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_FAR: Final = 6.0  # spreads of the bulk
_HANDFUL: Final = 10  # windows
_COUNT_RAD_S: Final = 2.0 * np.pi / 2000.0 / 0.01  # one count in a window


def without_gain(error: Array, quiet: Array) -> Array:
    """Take the wander of the gain out of a healthy run's error.

    Parameters
    ----------
    error, quiet
        The error, and the speed free of noise, in rad/s, shape (N,).
    """
    return error - float(error @ quiet) / float(quiet @ quiet) * quiet


def spread_rad_s(error: Array) -> float:
    """Return the spread of the bulk of an error.

    Parameters
    ----------
    error
        The error in rad/s, shape (N,).
    """
    return 1.4826 * float(np.median(np.abs(error)))


def not_far_out(error: Array) -> NDArray[np.bool_]:
    """Return the windows whose error is not far beyond the bulk, shape (N,).

    Parameters
    ----------
    error
        The error in rad/s, shape (N,).
    """
    near: NDArray[np.bool_] = np.abs(error) < _FAR * spread_rad_s(error)
    return near


def creeping(speed_rad_s: Array) -> NDArray[np.bool_]:
    """Return the windows in which the shaft turns by less than two counts, and not by none.

    What a window reports then is which of its neighbours a count falls into.

    Parameters
    ----------
    speed_rad_s
        Speed free of noise, shape (N,).
    """
    size = np.abs(speed_rad_s)
    creeps: NDArray[np.bool_] = (size > 0.0) & (size < 2.0 * _COUNT_RAD_S)
    return creeps


def shown_again(effect: Array, again: Array, far_rad_s: float) -> NDArray[np.bool_]:
    """Return the windows in which a second pair of runs shows as large an effect, if it is large.

    Whether the motor starts in a window or in the next, and on which side of a window's end an
    edge falls where it hardly turns, may hang on nothing at all.

    Parameters
    ----------
    effect, again
        What two pairs of runs differ by, in rad/s, shape (N,).
    far_rad_s
        What is large.
    """
    near = (effect * again > 0.0) & (np.abs(again) > 0.5 * np.abs(effect))
    return (np.abs(effect) < far_rad_s) | near


def strength_of(effect: Array, wanders: Array, noise_rad_s: float) -> float:
    """Root of an effect's deviance a window: its rms over the noise's, where nothing wanders.

    Of an effect that looks like another gain, no run tells more than how many wanders it amounts
    to; and what shows in a handful of windows only has no name, however large it is there.

    Parameters
    ----------
    effect
        What is hidden, in rad/s, shape (N,).
    wanders
        What a standard deviation of all that wanders from run to run changes, shape (N, K).
    noise_rad_s
        Root mean square of the noise.
    """
    usual = np.argsort(np.abs(effect))[:-_HANDFUL]
    hidden, ways = effect[usual] / noise_rad_s, wanders[usual] / noise_rad_s
    beta = np.linalg.solve(ways.T @ ways + np.eye(ways.shape[1]), ways.T @ hidden)
    deviance = float(np.sum((hidden - ways @ beta) ** 2) + beta @ beta)
    return float(np.sqrt(deviance / usual.size))
