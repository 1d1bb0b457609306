"""What is known of a model before a run is judged: its noise, its known misfit, its repeatability.

`usmbench identify` measures it on the runs that the model was fitted on and the model file carries
it under ``residual: diagnosis``; for a model without it, cautious values stand in its place.
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
from usmbench.diagnose.known.departures import departures, unwatched_warming
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.shapes import phase_nodes
from usmbench.diagnose.known.triangle_text import triangle_of, triangle_text
from usmbench.diagnose.known.wander import (
    LEAST,
    Wander,
    wander_from_mapping,
    wander_of_shares,
)
from usmbench.diagnose.noise.noise_model import Noise, noise_from_mapping
from usmbench.errors import InputError
from usmbench.model.extended import applied_effects
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.operating_points import places_among

Array = NDArray[np.float64]

KEY = "diagnosis"
_CAUTIOUS_CURVE = 0.2  # of the model's noise, at each node
_CAUTIOUS_LAG = 0.002  # of the step
_TABLE = 2001


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
    """

    noise: Noise | None
    features: Features
    mean: Array
    root: Array
    wander: Wander
    spikes_hz: float = 0.0
    habits: tuple[dict[str, Any], ...] = ()
    stated_rad_s: float = 0.0

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
        runs, habits = sorted({s.run for s in stretches}), applied_effects(self.habits)
        free = self.root != 0.0
        shaped, ways = np.any(free, axis=1), np.any(free, axis=0)
        off_rad_s = deviations_rad_s(self.features, self.mean, self.root)
        n_known, n_lasting = self.wander.n_constants, 0
        if self.wander.knows_warming:
            n_lasting = n_constants(max(lasts_s(stretches).values()))
        found = []
        for s in stretches:
            none = np.empty((s.context.n, 0))
            shapes = np.column_stack([none, *compress(self.features.columns(s), shaped)])
            own = departures(s, habits, n_known)
            between = between_nodes(s, self.features, off_rad_s)
            doubt = none if s.doubt_rad_s is None else s.doubt_rad_s
            further = unwatched_warming(s, n_known, n_lasting)
            apart = (own * (s.run == r) for r in runs)
            found.append(np.column_stack([shapes, between, doubt, further, *apart]))
        wanders = np.diag(np.tile(self.wander.deviations, len(runs)))
        known = self.root[np.ix_(shaped, ways)]
        unsure = np.eye(found[0].shape[1] - known.shape[0] - wanders.shape[0])
        return found, block_diag(known, unsure, wanders)

    def to_mapping(self) -> dict[str, Any]:
        """Return what the model file keeps."""
        return {
            "noise": None if self.noise is None else self.noise.to_mapping(),
            "features": self.features.to_mapping(),
            "mean": [float(f"{value:.5g}") for value in self.mean],
            "covariance_root": triangle_text(self.root / self.features.prior[:, None]),
            **self.wander.to_mapping(),
            "spikes_hz": self.spikes_hz,
            "habits": list(self.habits),
        }


def knowledge_of(model: HammersteinModel) -> Knowledge:
    """Return what a model carries, or cautious values.

    Parameters
    ----------
    model
        The model.

    Raises
    ------
    InputError
        The model carries something else under this key.
    """
    content = model.residual.get(KEY)
    if content is None:
        return _cautious(model)
    try:
        features = _features(content["features"])
        known = Knowledge(
            noise_from_mapping(content["noise"]),
            features,
            _mean(content["mean"], len(features.groups)),
            features.prior[:, None] * triangle_of(content["covariance_root"], len(features.groups)),
            wander_from_mapping(content),
            float(content["spikes_hz"]),
            tuple(content["habits"]),
        )
        applied_effects(known.habits)
    except (AttributeError, IndexError, KeyError, TypeError, ValueError, InputError) as error:
        raise InputError(
            f"the model's residual: {KEY} cannot be used ({error}); identify the model again"
        ) from error
    return known


def _mean(content: Any, n_shapes: int) -> Array:
    """Return how much of each shape a model file says the model leaves."""
    mean = np.array(content, dtype=np.float64)
    if mean.shape != (n_shapes,):
        raise ValueError(f"its {mean.size} shapes are not the {n_shapes} of this version")
    return mean


def _features(content: dict[str, Any]) -> Features:
    """Return the shapes that a model file keeps."""
    nodes_deg = tuple(float(node) for node in content["nodes_deg"])
    steepest_rad_s = content.get("steepest_rad_s")
    unmeasured_rad_s = content.get("unmeasured_rad_s", ())
    if len(nodes_deg) < 2 or np.any(np.diff(nodes_deg) <= 0.0):
        raise ValueError("features.nodes_deg does not rise")
    if len(unmeasured_rad_s) not in (0, len(nodes_deg)):
        raise ValueError("features.unmeasured_rad_s has not one value a node")
    return Features(
        nodes_deg,
        float(content["top_rad_s"]),
        int(content["n_constants"]),
        int(content.get("n_points", 1)),
        int(content.get("n_places", 0)),
        None if steepest_rad_s is None else float(steepest_rad_s),
        tuple(float(off) for off in unmeasured_rad_s),
    )


def _cautious(model: HammersteinModel) -> Knowledge:
    """Values for a model of which nothing but its noise is known."""
    noise_rad_s = float(np.median([p.noise_rad_s for p in model.points]))
    low_deg = min(p.phase_range_deg[0] for p in model.points)
    high_deg = max(p.phase_range_deg[1] for p in model.points)
    table_deg = np.linspace(low_deg, high_deg, _TABLE)
    speeds = [p.curve.speed_rad_s(table_deg) for p in model.points]
    features = Features(
        phase_nodes(table_deg, speeds),
        max(float(np.max(np.abs(speeds))), 1e-9),
        1,
        len(model.points),
        len(places_among(model.points, list(np.eye(len(model.points))))),
    )
    lags = {g: _CAUTIOUS_LAG for g in features.groups if g.startswith("lag")}
    deviation = {"phase": _CAUTIOUS_CURVE * noise_rad_s, **lags}
    groups = features.groups
    wander = wander_of_shares(LEAST, features)
    return Knowledge(
        None,
        features,
        np.zeros(len(groups)),
        np.diag([deviation.get(g, 0.0) for g in groups]),
        # Of a warm-up it says nothing, nor that one differs from another.
        replace(
            wander, warms_gain=0.0, warms_held_back_rad_s=0.0, warms_wider=0.0, warms_shift=0.0
        ),
        stated_rad_s=noise_rad_s,
    )
