"""Difference equations of the linear part, run forward from a steady state."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter, lfilter_zi

from usmbench.model.hammerstein import LinearPart

Array = NDArray[np.float64]


def delayed(values: Array, windows: int) -> Array:
    """Return the values late by whole windows, the first one held before the start.

    Parameters
    ----------
    values
        A signal, shape (N,) or (N, K).
    windows
        Delay, 0 or more.
    """
    if windows == 0:
        return values
    late = np.empty_like(values)
    late[:windows] = values[0]
    late[windows:] = values[: max(values.shape[0] - windows, 0)]
    return late


def free_run(linear: LinearPart, settled_rad_s: Array) -> Array:
    """Return the output of the linear part, free-running.

    Parameters
    ----------
    linear
        The difference equation.
    settled_rad_s
        Its input v, the static curve's output, shape (N,) or (N, K): K signals at once.

    Returns
    -------
    Array
        Output of the same shape. It starts in the steady state of the first input.
    """
    late = delayed(settled_rad_s, linear.dead_time_windows)
    return filtered(linear.b, linear.a, late)


def filtered(b: Array, a: Array, signal: Array) -> Array:
    """Run ``B(q) / (1 + A(q))`` over a signal from the steady state of its first sample.

    Parameters
    ----------
    b
        Numerator b_0 …, shape (n_b + 1,).
    a
        Denominator a_1 … without the leading 1, shape (n_a,).
    signal
        Shape (N,) or (N, K).
    """
    denominator = np.r_[1.0, a]
    order = max(b.size, denominator.size) - 1
    if order == 0:
        return signal * float(b[0])
    start = lfilter_zi(b, denominator)
    state = start[:, None] * signal[0] if signal.ndim == 2 else start * signal[0]
    result: Array = lfilter(b, denominator, signal, axis=0, zi=state)[0]
    return result


def time_constant_s(linear: LinearPart) -> float | None:
    """Return the time constant τ of the slowest real decaying mode.

    Parameters
    ----------
    linear
        The difference equation. A pole z decays as ``exp(−window/τ)``, so τ = −window / ln z.

    Returns
    -------
    float or None
        None where the samples have no time step, or no pole is real, positive and stable.
    """
    poles = np.roots(np.r_[1.0, linear.a])
    real = poles.real[(np.abs(poles.imag) < 1e-9) & (poles.real > 0.0) & (poles.real < 1.0)]
    if linear.window_s is None or real.size == 0:
        return None
    return -linear.window_s / math.log(float(real.max()))


def memory_windows(linear: LinearPart, left: float = 1e-3) -> int:
    """Return after how many windows the start is forgotten.

    Parameters
    ----------
    linear
        The difference equation.
    left
        Share of an initial error that may be left.
    """
    poles = np.roots(np.r_[1.0, linear.a])
    slowest = min(float(np.max(np.abs(poles), initial=0.0)), 0.9999)
    decay = 0 if slowest < 1e-6 else math.ceil(math.log(left) / math.log(slowest))
    return linear.dead_time_windows + linear.b.size - 1 + decay
