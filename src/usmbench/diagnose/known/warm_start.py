"""What a run shows whose motor is warm at its start, where those of its model began cold."""

from dataclasses import replace
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.cutting.warmth import TIME_CONSTANTS_S
from usmbench.diagnose.known.features import WARMING, Features

Array = NDArray[np.float64]

_HALF_WAY = 0.5  # standard deviation of how warm it is
_SPEED = 0.5  # of the highest: at that a motor warms neither more nor less than by being driven


def warm_shapes(stretch: Stretch, features: Features) -> Array:
    """Return the shapes of warming in a run that begins as warm as driving makes the motor at last.

    What the motor is known to do as it warms it has then done at the start. The heat of before
    fades with each thermal time constant, while the run warms it as from cold.

    Parameters
    ----------
    stretch
        The stretch.
    features
        The model's shapes.

    Returns
    -------
    Array
        Change of speed for each of `Features.warming`, shape (N, H).
    """
    powers = np.array((1.0, _SPEED * features.top_rad_s, features.top_rad_s**2))
    fades = np.exp(-stretch.context.t_s / np.array(TIME_CONSTANTS_S)[:, None])
    before = replace(stretch, warmth=np.multiply.outer(powers, fades))
    warms = features.warms_at[np.isin(features.groups, WARMING)] >= 0
    return np.column_stack(list(compress(features.warming(before), warms)))


def warm_means(features: Features, left: Array) -> Array:
    """Return how much of the `warm_shapes` each thermal time constant has, shape (H, C).

    Parameters
    ----------
    features
        The model's shapes.
    left
        How much of each it is known to leave, shape (K,).
    """
    at = features.warms_at
    warms = at >= 0
    means: Array = left[warms, None] * (at[warms, None] == np.arange(features.n_constants))
    return means


def warm_root(features: Features, left: Array, root: Array) -> Array:
    """Return a square root of the covariance of the `warm_shapes` where none knows how warm it is.

    Parameters
    ----------
    features
        The model's shapes.
    left
        How much of each it is known to leave, shape (K,).
    root
        Square root of the covariance of how far a run may be from that, shape (K, K).

    Returns
    -------
    Array
        Shape (H, H).
    """
    ways = np.hstack([_HALF_WAY * warm_means(features, left), root[features.warms_at >= 0]])
    return np.asarray(np.linalg.qr(ways.T, mode="r")).T
