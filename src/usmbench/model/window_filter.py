"""What hangs on a rotor, from what windows show of the rotor to what they show of it."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import companion, expm
from scipy.signal import ss2tf

from usmbench.model.effects.first_order import Lag, lag_coefficients

Array = NDArray[np.float64]
Filter = tuple[Array, Array]
"""Numerator and denominator, as `scipy.signal.lfilter` takes them."""

# Largest zero of the rotor's filter with which its windows tell what drove it. Nothing measured
# sets it.
_TOLD = 0.95


def behind_lag(numerator: Array, denominator: Array, lag: Lag, window_s: float) -> Filter:
    """Return the filter of what hangs on a rotor that follows held speeds with a lag.

    The rotor's windows tell what it was driven by, and that the output's windows. Where they do
    not, since the delay takes most of a window, the commands are taken to act at its start.

    Parameters
    ----------
    numerator, denominator
        Transfer function from the rotor's speed to the output, by falling powers of s, shape (m,)
        and (n + 1,), m ≤ n.
    lag
        How the rotor follows, and what windows show; with a time constant of 0 the rotor itself is
        held through each.
    window_s
        Duration of a window.
    """
    if lag.tau_s <= 0.0:
        return held(numerator, denominator, window_s)
    tau, sampled = lag.tau_s / window_s, lag.sampled
    late = lag.delay_s / window_s - math.floor(lag.delay_s / window_s)
    pole, rotor_b = lag_coefficients(tau, late, sampled=sampled)
    # Without a part of the window it began in, a change is not told from one a window later.
    if rotor_b[0] <= 0.0 or np.max(np.abs(np.roots(rotor_b)), initial=0.0) > _TOLD:
        late = 0.0
        pole, rotor_b = lag_coefficients(tau, late, sampled=sampled)
    follows = np.convolve(denominator, [lag.tau_s, 1.0])
    b, a = held(numerator, follows, window_s, late * window_s, sampled=sampled)
    return np.convolve(b, [1.0, -pole]), np.convolve(a, rotor_b)


def held(
    numerator: Array,
    denominator: Array,
    window_s: float,
    late_s: float = 0.0,
    *,
    sampled: bool = False,
) -> Filter:
    """Return the filter from an input that is held for windows to what they show of the output.

    The exponential of x′ = A x + B u, u′ = 0, z′ = C x carries state and integral over a part of a
    window, exactly (Van Loan 1978, doi:10.1109/TAC.1978.1101743).

    Parameters
    ----------
    numerator, denominator
        As in `behind_lag`.
    window_s
        Duration of a window.
    late_s
        How long after a window's start the input changes, less than a window.
    sampled
        Whether windows show speeds at their ends, not averages.
    """
    n = denominator.size - 1
    rates = np.zeros((n + 2, n + 2))
    rates[:n, :n] = companion(denominator)
    rates[0, n] = 1.0 / denominator[0]
    rates[n + 1, n - numerator.size : n] = numerator
    before, after = expm(late_s * rates), expm((window_s - late_s) * rates)
    # Columns: the state, the input of the window before, and the window's own.
    between = np.column_stack((before[:n, : n + 1], np.zeros(n)))
    ends = after[:n, :n] @ between
    ends[:, -1] += after[:n, n]
    if sampled:
        shown = rates[n + 1, :n] @ ends
    else:
        shown = np.append(before[n + 1, : n + 1], after[n + 1, n]) + after[n + 1, :n] @ between
        shown /= window_s
    last, now = (
        ss2tf(ends[:, :n], ends[:, [k]], shown[None, :n], shown[[[k]]]) for k in (n, n + 1)
    )
    return np.append(now[0], 0.0) + np.append(0.0, last[0]), now[1]
