"""What a model is known to leave, as a counter reports it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.model.extended import Applied, through

Array = NDArray[np.float64]


def expected_as_counted(
    known: Knowledge, stretch: Stretch, change_rad_s: Array, counters: Sequence[Applied]
) -> Array:
    """Return the mean residual that is no news behind a counter that does not count right.

    What takes part of the speed, or turns its sign, does so to the model's error as well.

    Parameters
    ----------
    known
        What is known of the model.
    stretch
        The stretch.
    change_rad_s
        What other causes change before the counter, shape (N,).
    counters
        What the counter does.
    """
    shaft_rad_s = stretch.simulated_rad_s + change_rad_s
    off_rad_s = known.expected_rad_s(replace(stretch, simulated_rad_s=shaft_rad_s))
    reported, simulated = (
        through(counters, "counter", speed_rad_s, stretch.context)
        for speed_rad_s in (shaft_rad_s + off_rad_s, shaft_rad_s)
    )
    return reported - simulated
