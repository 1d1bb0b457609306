"""What a curve may be off by just beyond the phases that were measured, where rows still count."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.shapes import felt
from usmbench.identify.like_phases import SAME_PHASE

Array = NDArray[np.float64]

# Of what it goes on by: two standard deviations stop it at the end. Nothing measured sets it.
_SATURATES = 0.5


def beyond_ends(stretches: Sequence[Stretch], features: Features) -> Iterator[Array]:
    """Yield what a curve may be off by beyond its ends, in columns of one standard deviation.

    It goes on as it ends; a motor may saturate right there.

    Parameters
    ----------
    stretches
        The stretches.
    features
        What the model may leave; the first and the last of its nodes are the ends.

    Yields
    ------
    numpy.ndarray
        Of each stretch one column an end that any of them passes and an operating point, in
        rad/s, shape (N, E).
    """
    low_deg, high_deg = features.nodes_deg[0], features.nodes_deg[-1]
    same_deg = SAME_PHASE * (high_deg - low_deg)
    passed = [
        (side, end_deg)
        for side, end_deg in ((-1.0, low_deg), (1.0, high_deg))
        if any(np.any(side * (s.context.phase_deg - end_deg) > same_deg) for s in stretches)
    ]
    for s in stretches:
        phase_deg, columns = s.context.phase_deg, [np.empty((s.context.n, 0))]
        for side, end_deg in passed:
            held_deg = side * np.minimum(side * phase_deg, side * end_deg)
            further = s.context.moved_rad_s(held_deg)
            columns += [(further * point)[:, None] for point in s.points]
        yield -_SATURATES * felt(s.context.linear, np.hstack(columns))
