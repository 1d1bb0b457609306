"""Shapes of what a model misses after steps, and near standstill."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.rotor_states import KINDS, step_kind
from usmbench.model.linear import delayed
from usmbench.model.polygon import hats

Array = NDArray[np.float64]

CELLS = (7, 5, 3, 2, 2, 2)  # nodes along each speed at each lag
_DENSER = 2.5  # how much denser these are near standstill, where friction holds the rotor
# Speeds near standstill, as shares of the highest: a rotor that sticks starts with a jump.
_CREEP = (0.0, 0.006, 0.012, 0.02, 0.03, 0.05, 0.08)
N_NEAR_STANDSTILL = KINDS * (len(_CREEP) - 2)


def after_steps(stretch: Stretch, top_rad_s: float) -> Iterator[Array]:
    """Yield the steps by the speeds that they lead from and to, shape (N,) each.

    A step shows at each lag whether or not another came since: else a phase that glides, which
    shows only how long a response lasts in all, would pass for one that shows its course.

    Parameters
    ----------
    stretch
        The stretch.
    top_rad_s
        Highest speed of the model.
    """
    stepped = np.where(stretch.lag == 0, stretch.step_rad_s, 0.0)
    after = np.clip(stretch.settled_rad_s / top_rad_s, -1.0, 1.0)
    before = np.clip(after - stepped / top_rad_s, -1.0, 1.0)
    for lag, n_nodes in enumerate(CELLS):
        even = np.linspace(-1.0, 1.0, n_nodes)
        nodes = np.sign(even) * np.abs(even) ** _DENSER
        ends = list(hats(after, nodes))
        for place in (1.0, *stretch.places):
            for start in hats(before, nodes):
                yield from (delayed(place * stepped * start * end, lag) for end in ends)


def near_standstill(stretch: Stretch, top_rad_s: float) -> Iterator[Array]:
    """Yield speeds lost near standstill, by the kind of the last step, shape (N,) each.

    Parameters
    ----------
    stretch
        The stretch.
    top_rad_s
        Highest speed of the model.
    """
    settled = stretch.settled_rad_s
    kind = step_kind(stretch)
    near = list(hats(np.abs(settled) / top_rad_s, np.array(_CREEP)))[1:-1]
    for place in (1.0, *stretch.places):
        for lost in near:
            yield from (place * np.sign(settled) * lost * (kind == k) for k in range(KINDS))
