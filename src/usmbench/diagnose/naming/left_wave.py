"""Whether what is left swings in a wave of one frequency."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch

Array = NDArray[np.float64]

_MOST = 0.5  # of the power; nothing measured sets it, nor how few windows tell a wave
_FEWEST = 64
_WIDE = 2  # lines on either side, to which a Hann window spreads one


def left_wave_hz(stretches: Sequence[Stretch], left_rad_s: Sequence[Array]) -> float | None:
    """Return the frequency of which most of what is left is; None where there is no such one.

    The longest run tells. Of what swings faster than half the rate of the windows it is the
    frequency that these fold it to.

    Parameters
    ----------
    stretches
        The runs.
    left_rad_s
        What is left of each, in rad/s, shape (N,).

    Returns
    -------
    float or None
        In Hz: the mean of the strongest line of the spectrum and those beside it, by power.
    """
    longest = int(np.argmax([left.size for left in left_rad_s]))
    left, window_s = left_rad_s[longest], stretches[longest].context.window_s
    if left.size < _FEWEST:
        return None
    power = np.abs(np.fft.rfft((left - np.mean(left)) * np.hanning(left.size))) ** 2
    at = int(np.argmax(power))
    lines = np.arange(max(at - _WIDE, 0), min(at + _WIDE + 1, power.size))
    near = float(np.sum(power[lines]))
    if near <= _MOST * float(np.sum(power)):
        return None
    return float(lines @ power[lines]) / near / (left.size * window_s)
