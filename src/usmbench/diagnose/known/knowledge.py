"""What is known of a model before a run is judged: its noise, its known misfit, its repeatability.

`usmbench identify` measures it on the runs that the model was fitted on.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import compress
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from usmbench.diagnose.cutting.long_runs import lasts_s
from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.cutting.warmth import n_constants
from usmbench.diagnose.known.between_nodes import between_nodes, deviations_rad_s
from usmbench.diagnose.known.beyond_ends import beyond_ends
from usmbench.diagnose.known.departures import departures, unwatched_warming
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.wander import Wander
from usmbench.diagnose.known.warm_start_shapes import (
    unsure_in_gaps,
    warm_root,
    warm_shapes,
)
from usmbench.diagnose.noise.noise_model import Noise
from usmbench.model.applied import Applied, applied_effects

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Knowledge:
    """What is known beforehand.

    Parameters
    ----------
    noise
        The noise; None where the model says nothing and the run itself must tell.
    features
        Shapes that the model may leave.
    mean
        How much of each it leaves, shape (K,).
    root
        Square root of the covariance of how far a run may be from that: each column is one way in
        which it may, shape (K, K).
    wander
        How far a run may be from that by what differs from run to run.
    spikes_hz
        Rate of windows that stand alone in the identified runs.
    habits
        What the bench does to every command and the model does not know, such as its own grid of
        phases: entries of a model's `effects`.
    stated_rad_s
        Standard deviation of the noise that a model states which says no more of it; 0 for none.
    began_warm
        Names of runs that look as if the motor had been warm when they began; where there are any,
        each run may have begun so.
    sporadic
        The model's effects that strike single windows.
    """

    noise: Noise | None
    features: Features
    mean: Array
    root: Array
    wander: Wander
    spikes_hz: float = 0.0
    habits: tuple[dict[str, Any], ...] = ()
    stated_rad_s: float = 0.0
    began_warm: tuple[str, ...] = ()
    sporadic: tuple[Applied, ...] = ()

    def expected_spikes_hz(self, *, with_left_out: bool) -> float:
        """Return how often a window stands alone, by the identified runs and the model's effects.

        Parameters
        ----------
        with_left_out
            Whether effects count whose windows are left out where they are found.
        """
        counted = (a for a in self.sporadic if with_left_out or not a.effect.left_out)
        return self.spikes_hz + sum(a.values["rate_hz"] for a in counted)

    @property
    def habit_names(self) -> frozenset[str]:
        """Names of the causes that healthy runs show anyhow."""
        return frozenset(habit["name"] for habit in self.habits)

    @property
    def nothing(self) -> "Knowledge":
        """The same noise, and no shape that the model is known to leave."""
        return replace(self, mean=np.zeros_like(self.mean), root=np.zeros_like(self.root))

    def expected_rad_s(self, stretch: Stretch) -> Array:
        """Return the mean residual of a stretch that is no news.

        Parameters
        ----------
        stretch
            The stretch.
        """
        return self.features.combined(stretch, self.mean)

    def background(self, stretches: Sequence[Stretch]) -> tuple[list[Array], Array]:
        """Return what may differ without being news: shapes, and in which ways they may.

        Parameters
        ----------
        stretches
            The runs.

        Returns
        -------
        shapes
            One array a stretch, shape (N, S), mostly zeros: the same column is the same difference
            on all of them.
        root
            Square root of the coefficients' covariance, shape (S, K): the columns of
            ``shapes @ root`` are differences of one standard deviation.
        """
        # A motor that has stood starts as on another day.
        starts, habits = sorted({(s.run, s.start) for s in stretches}), applied_effects(self.habits)
        free = self.root != 0.0
        shaped, ways = np.any(free, axis=1), np.any(free, axis=0)
        off_rad_s = deviations_rad_s(self.features, self.mean, self.root)
        n_known, n_lasting = self.wander.n_constants, 0
        if self.wander.knows_warming:
            n_lasting = n_constants(max(lasts_s(stretches).values()))
        found = []
        in_gaps = unsure_in_gaps(stretches, self.features, self.mean)
        beyond = beyond_ends(stretches, self.features)
        for s, gaps, ends in zip(stretches, in_gaps, beyond, strict=True):
            none = np.empty((s.context.n, 0))
            shapes = np.column_stack([none, *compress(self.features.columns(s), shaped)])
            own = self._own(s, habits)
            between = between_nodes(s, self.features, off_rad_s)
            doubt = none if s.doubt_rad_s is None else s.doubt_rad_s
            further = unwatched_warming(s, n_known, n_lasting)
            apart = (own * ((s.run, s.start) == start) for start in starts)
            found.append(np.column_stack([shapes, between, ends, doubt, further, gaps, *apart]))
        wanders = block_diag(*[self._own_root] * len(starts))
        known = self.root[np.ix_(shaped, ways)]
        unsure = np.eye(found[0].shape[1] - known.shape[0] - wanders.shape[0])
        return found, block_diag(known, unsure, wanders)

    def _own(self, stretch: Stretch, habits: Sequence[Applied]) -> Array:
        """Return what each run does on its own, shape (N, O)."""
        own = departures(stretch, habits, self.wander.n_constants)
        if not self.began_warm:
            return own
        return np.column_stack([own, warm_shapes(stretch, self.features)])

    @property
    def _own_root(self) -> Array:
        """Square root of the covariance of what each run does on its own, shape (O, O)."""
        wander = np.diag(self.wander.deviations)
        if not self.began_warm:
            return wander
        return block_diag(wander, warm_root(self.features, self.mean, self.root))
