"""The scatter of causes that act by chance, such as counts that are lost now and then.

What strikes at random, by the same amount each time, scatters as a Poisson process does: the
variance is in proportion to the mean. By how much, the runs say.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Mask
from usmbench.identify.robust_fit import OVER_MEDIAN

Array = NDArray[np.float64]

_FEWEST = 50  # rows elsewhere that tell the noise


def chance_scatter_rad_s(
    changes_rad_s: Sequence[Array], left_rad_s: Sequence[Array], uses: Sequence[Mask]
) -> list[Array]:
    """Return the standard deviation of what chance does on each row, shape (N,) a stretch.

    Parameters
    ----------
    changes_rad_s
        What it does in the mean, by stretch, shape (N,).
    left_rad_s
        What is left of the speed beside that, shape (N,).
    uses
        Rows to judge, shape (N,).
    """
    use, left = np.concatenate(list(uses)), np.concatenate(list(left_rad_s))
    change = np.concatenate(list(changes_rad_s))
    acts = use & (change != 0.0)
    rest = np.abs(left[use & ~acts])
    noise = (OVER_MEDIAN * float(np.median(rest))) ** 2 if rest.size >= _FEWEST else 0.0
    mean = max(float(np.sum(np.abs(change[acts]))), 1e-12)
    # That it does more or less than is said of it is no scatter.
    more = float(np.sum(left[acts] * np.sign(change[acts]))) / mean
    beyond = float(np.sum((left - more * change)[acts] ** 2 - noise))
    return [np.sqrt(max(beyond, 0.0) / mean * np.abs(each)) for each in changes_rad_s]
