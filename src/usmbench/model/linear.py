"""Difference equations of the linear part, run forward."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from usmbench.model.hammerstein import LinearPart
from usmbench.model.torque_limit import limited_run, limited_runs

Array = NDArray[np.float64]

_START_STEPS = 20
_START_NUDGE, _START_CLOSE = 1e-4, 1e-6  # rad/s


def delayed(values: Array, windows: int, before: float | Array = 0.0) -> Array:
    """Return the values late by whole windows.

    Parameters
    ----------
    values
        A signal, shape (N,) or (N, K).
    windows
        Delay, 0 or more.
    before
        What the signal was before its first sample.
    """
    if windows == 0:
        return values
    late = np.empty_like(values)
    late[:windows] = before
    late[windows:] = values[: max(values.shape[0] - windows, 0)]
    return late


def free_run(linear: LinearPart, settled_rad_s: Array, start_rad_s: float | None = None) -> Array:
    """Return the output of the dynamics, free-running, with their torque limit if they have one.

    Parameters
    ----------
    linear
        The difference equation.
    settled_rad_s
        Its input v, the static curve's output, shape (N,).
    start_rad_s
        Settled speed before the first sample; None takes that of the first sample.

    Returns
    -------
    Array
        Output, shape (N,).
    """
    start = float(settled_rad_s[0]) if start_rad_s is None else start_rad_s
    if linear.slip_limit_rad_s is not None:
        tau, dead = _lag_windows(linear)
        return limited_run(tau, dead, linear.slip_limit_rad_s, settled_rad_s, start)
    moved = from_rest(linear.b, linear.a, linear.dead_time_windows, settled_rad_s - start)
    return moved + start * linear.gain


def free_runs(linear: LinearPart, settled_rad_s: Sequence[Array]) -> list[Array]:
    """Return the outputs of several runs that start settled, as `free_run` does one by one.

    Parameters
    ----------
    linear
        The difference equation.
    settled_rad_s
        Its inputs, shape (N,) each.

    Returns
    -------
    list of Array
        Shape (N,) each.
    """
    if linear.slip_limit_rad_s is None:
        return [free_run(linear, settled) for settled in settled_rad_s]
    starts = [float(settled[0]) for settled in settled_rad_s]
    return limited_runs(*_lag_windows(linear), linear.slip_limit_rad_s, settled_rad_s, starts)


def from_rest(b: Array, a: Array, dead_time_windows: int, signal: Array) -> Array:
    """Run ``q^−D B(q) / (1 + A(q))`` over a signal that was 0 before.

    Parameters
    ----------
    b
        Numerator b_0 …, shape (n_b + 1,).
    a
        Denominator a_1 … without the leading 1, shape (n_a,).
    dead_time_windows
        Dead time D.
    signal
        Shape (N,) or (N, K).
    """
    late = delayed(signal, dead_time_windows)
    if a.size == 0:
        lags = enumerate(b.tolist())
        return np.asarray(sum(value * delayed(late, k) for k, value in lags), dtype=np.float64)
    result: Array = lfilter(b, np.concatenate(([1.0], a)), late, axis=0)
    return result


def fading(b: Array, a: Array, dead_time_windows: int, n: int) -> Array:
    """Return how a settled speed of 1 before the first sample fades when the input is 0.

    Parameters
    ----------
    b, a, dead_time_windows
        As in `from_rest`.
    n
        Number of samples.

    Returns
    -------
    Array
        Shape (n,). The part of the free run that the unknown start of a record adds.
    """
    gain = float(b.sum()) / (1.0 + float(a.sum()))
    faded: Array = gain - from_rest(b, a, dead_time_windows, np.ones(n))
    return faded


def fitted_start_rad_s(linear: LinearPart, settled_rad_s: Array, speed_rad_s: Array) -> float:
    """Return the settled speed before the first sample that suits a measurement best.

    Parameters
    ----------
    linear
        The difference equation.
    settled_rad_s
        The static curve's output v, shape (N,).
    speed_rad_s
        The measured speed, shape (N,).

    Returns
    -------
    float
        The least-squares estimate, or v's first value where no sample remembers the start.
    """
    n = min(settled_rad_s.size, memory_windows(linear) + 1)
    shape = fading(linear.b, linear.a, linear.dead_time_windows, n)
    power = float(shape @ shape)
    start_rad_s = float(settled_rad_s[0])
    if power < 1e-12:
        return start_rad_s
    settled_rad_s, speed_rad_s = settled_rad_s[:n], speed_rad_s[:n]
    # One step is exact for linear dynamics; with a torque limit the start fades by another shape.
    for _ in range(_START_STEPS):
        run = free_run(linear, settled_rad_s, start_rad_s)
        if linear.slip_limit_rad_s is not None:
            shape = free_run(linear, settled_rad_s, start_rad_s + _START_NUDGE) - run
            shape /= _START_NUDGE
        step = float(shape @ (speed_rad_s - run)) / float(shape @ shape)
        start_rad_s += step
        if linear.slip_limit_rad_s is None or abs(step) < _START_CLOSE:
            break
    return start_rad_s


def _lag_windows(linear: LinearPart) -> tuple[float, float]:
    """Time constant and dead time in windows of a first-order lag."""
    tau_s, dead_s = time_constant_s(linear), dead_time_s(linear)
    if linear.window_s is None or tau_s is None or dead_s is None:
        raise ValueError("a torque limit needs a first-order lag with a time step")
    return tau_s / linear.window_s, max(dead_s / linear.window_s, 0.0)


def poles(a: Array) -> NDArray[np.complex128]:
    """Return the roots of ``1 + Σ a_i z^−i``.

    Parameters
    ----------
    a
        Denominator a_1 … without the leading 1, shape (n_a,).

    Returns
    -------
    Array
        Shape (n_a,).
    """
    found = -a if a.size == 1 else np.roots(np.concatenate(([1.0], a)))
    return np.asarray(found, dtype=np.complex128)


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
    found = poles(linear.a)
    real = found.real[(np.abs(found.imag) < 1e-9) & (found.real > 0.0) & (found.real < 1.0)]
    if linear.window_s is None or real.size == 0:
        return None
    return -linear.window_s / math.log(float(real.max()))


def dead_time_s(linear: LinearPart) -> float | None:
    """Return the true dead time: the mean delay of the response without its time constants.

    Parameters
    ----------
    linear
        The difference equation. Speeds are window averages and phases are held through the
        window in which they were commanded, which adds no delay between equally numbered
        windows; so the mean delay ``Σ k h_k`` of the impulse response h is the dead time plus
        the time constants, and a part of a window counts.

    Returns
    -------
    float or None
        None where the samples have no time step or a pole is not real, positive and stable.
    """
    found = poles(linear.a)
    plain = (np.abs(found.imag) < 1e-9) & (found.real > 0.0) & (found.real < 1.0)
    if linear.window_s is None or not np.all(plain):
        return None
    lags_a, lags_b = np.arange(1, linear.a.size + 1), np.arange(linear.b.size)
    mean = linear.dead_time_windows + float(lags_b @ linear.b) / float(linear.b.sum())
    mean -= float(lags_a @ linear.a) / (1.0 + float(linear.a.sum()))
    lags = float(np.sum(-1.0 / np.log(found.real))) if found.size else 0.0
    return linear.window_s * (mean - lags)


def memory_windows(linear: LinearPart, left: float = 1e-3) -> int:
    """Return after how many windows the start is forgotten.

    Parameters
    ----------
    linear
        The difference equation.
    left
        Share of an initial error that may be left.
    """
    slowest = min(float(np.max(np.abs(poles(linear.a)), initial=0.0)), 0.9999)
    decay = 0 if slowest < 1e-6 else math.ceil(math.log(left) / math.log(slowest))
    return linear.dead_time_windows + linear.b.size - 1 + decay
