"""What a curve's known error may be between two of the phases at which it is kept."""

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.gaps import KINK
from usmbench.diagnose.known.shapes import felt
from usmbench.model.polygon import hats, turns

Array = NDArray[np.float64]

_BY_CHANCE = 2.0  # standard deviations by which a slope may turn at a node
_TRIFLE = 2e-4  # of the highest speed


def deviations_rad_s(features: Features, mean: Array, root: Array) -> Array:
    """Return how far off a straight line between two nodes may be at each operating point.

    Parameters
    ----------
    features
        What the model may leave.
    mean, root
        How much of each shape it leaves, and in which ways that may differ; shapes (K,), (K, K).

    Returns
    -------
    numpy.ndarray
        Standard deviations halfway between two nodes, shape (points, nodes − 1); 0 where measured
        phases lie between them, and the slope turns at neither by more than by chance.
    """
    width_deg = np.diff(features.nodes_deg)
    n = width_deg.size + 1
    turn = turns(np.array(features.nodes_deg))
    unmeasured = np.array(features.between_rad_s or np.zeros(width_deg.size))
    off = []
    for k in range(features.n_points):
        own = slice(k * n, (k + 1) * n)
        by_chance = np.linalg.norm(turn @ root[own], axis=1)
        turned = np.maximum(np.abs(turn @ mean[own]) - _BY_CHANCE * by_chance, 0.0)
        bends = KINK * turned * np.minimum(width_deg[:-1], width_deg[1:])
        off.append(np.maximum.reduce([np.r_[bends, 0.0], np.r_[0.0, bends], unmeasured]))
    return np.where(np.array(off) > _TRIFLE * features.top_rad_s, off, 0.0)


def between_nodes(stretch: Stretch, features: Features, off_rad_s: Array) -> Array:
    """Return what a curve may be off by between nodes, in columns of one standard deviation.

    Parameters
    ----------
    stretch
        The stretch.
    features
        What the model may leave.
    off_rad_s
        As `deviations_rad_s` returns them.

    Returns
    -------
    numpy.ndarray
        One column each for those that are not 0, shape (N, B).
    """
    phase_deg = stretch.context.phase_deg
    near = list(hats(phase_deg, np.array(features.nodes_deg)))
    at = np.argwhere(off_rad_s)
    # Two hats that overlap are an arch between their nodes, a quarter high.
    columns = [4.0 * near[i] * near[i + 1] * stretch.points[k] for k, i in at]
    settled = np.column_stack([np.empty((phase_deg.size, 0)), *columns])
    return felt(stretch.context.linear, settled) * off_rad_s[tuple(at.T)]
