"""What a run shows whose motor is warm at its start, or after a gap, and nobody knows how warm."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.cutting.warmth import TIME_CONSTANTS_S
from usmbench.diagnose.known.features import WARMING, Features

Array = NDArray[np.float64]

# How long a motor may have been driven before, and then have stood.
_DRIVEN_S = (10.0, 32.0, 100.0, 316.0, 1000.0, 3160.0)
_STOOD_S = (0.0, 3.2, 10.0, 32.0, 100.0, 316.0)
_SPEED = 0.5  # of the highest: at that a motor warms neither more nor less than by being driven


def histories(n_constants: int) -> Array:
    """Return how warm a motor may be at each thermal time constant for having been driven before.

    Parameters
    ----------
    n_constants
        Number of constants, from the shortest on.

    Returns
    -------
    Array
        As shares of what driving makes it at last, one history a row, shape (J, C).
    """
    constants_s = np.array(TIME_CONSTANTS_S[:n_constants])
    driven = -np.expm1(-np.array(_DRIVEN_S)[:, None, None] / constants_s)
    stood = np.exp(-np.array(_STOOD_S)[None, :, None] / constants_s)
    shares: Array = (driven * stood).reshape(-1, n_constants)
    return shares


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
    return _as_warm(stretch, features, np.multiply.outer(powers, fades))


def _as_warm(stretch: Stretch, features: Features, warmth: Array) -> Array:
    """Return the shapes of warming, of a motor that is as warm, shape (N, H)."""
    warms = features.warms_at[np.isin(features.groups, WARMING)] >= 0
    warm = replace(stretch, warmth=warmth)
    return np.column_stack(list(compress(features.warming(warm), warms)))


def unsure_in_gaps(
    stretches: Sequence[Stretch], features: Features, left: Array
) -> Iterator[Array]:
    """Yield what each stretch may be off by for gaps in which the motor may have been driven.

    Parameters
    ----------
    stretches
        The stretches.
    features
        The model's shapes.
    left
        How much of each it is known to leave, shape (K,).

    Yields
    ------
    Array
        One column a run with such gaps, of one standard deviation, in rad/s, shape (N, G).
    """
    runs = sorted({s.run for s in stretches if s.unsure_warmth is not None})
    warms = features.warms_at >= 0
    for s in stretches:
        off_rad_s = np.zeros(s.context.n)
        if s.unsure_warmth is not None:
            off_rad_s = _as_warm(s, features, s.unsure_warmth) @ left[warms]
        yield np.outer(off_rad_s, [s.run == run for run in runs])


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

    Any of the `histories` is as likely.

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
    shares = histories(features.n_constants)
    warm = warm_means(features, left) @ shares.T / np.sqrt(len(shares))
    ways = np.hstack([warm, root[features.warms_at >= 0]])
    return np.asarray(np.linalg.qr(ways.T, mode="r")).T
