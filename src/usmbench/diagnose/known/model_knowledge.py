"""What a model file keeps of how to judge runs, under ``residual: diagnosis``.

For a model without it, cautious values stand in its place.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.knowledge import Knowledge
from usmbench.diagnose.known.phase_nodes import TABLED, phase_nodes
from usmbench.diagnose.known.triangle_text import triangle_of, triangle_text
from usmbench.diagnose.known.wander import wander_from_mapping, wander_of_shares
from usmbench.diagnose.known.wander_shares import LEAST
from usmbench.diagnose.noise.noise_model import noise_from_mapping
from usmbench.errors import CauseError, InputError
from usmbench.model.applied import applied_effects
from usmbench.model.hammerstein import HammersteinModel
from usmbench.model.operating_points import places_among
from usmbench.settings.schema import check
from usmbench.settings.yaml_source import Source

Array = NDArray[np.float64]

_KEY = "diagnosis"
# Version of what coefficients mean: 1 had the dead zone's in degrees, 2 fewer nodes, 3 no braking.
_SHAPES = 4
_CAUTIOUS_CURVE = 0.2  # of the model's noise, at each node
_CAUTIOUS_LAG = 0.002  # of the step


def with_known(model: HammersteinModel, known: Knowledge) -> HammersteinModel:
    """Return a model that carries what is known of it.

    Parameters
    ----------
    model
        The model.
    known
        What is known.
    """
    content = {
        "noise": None if known.noise is None else known.noise.to_mapping(),
        "shapes": _SHAPES,
        "features": known.features.to_mapping(),
        "mean": [float(f"{value:.5g}") for value in known.mean],
        "covariance_root": triangle_text(known.root / known.features.prior[:, None]),
        **known.wander.to_mapping(),
        "spikes_hz": known.spikes_hz,
        "habits": list(known.habits),
    }
    return replace(model, residual={**model.residual, _KEY: content})


def knowledge_of(model: HammersteinModel) -> Knowledge:
    """Return what a model carries, or cautious values.

    Parameters
    ----------
    model
        The model.

    Raises
    ------
    InputError
        The model carries something else under this key; the message names its file.
    """
    content = model.residual.get(_KEY)
    if content is None:
        return _cautious(model)
    source = Source(f"{model.name} (residual.{_KEY})", content)
    if isinstance(content, dict) and content.get("shapes", _SHAPES) != _SHAPES:
        raise source.error((), "its shapes are those of another version; identify the model again")
    check(source, "diagnosis")
    try:
        return _knowledge(content, len(model.points))
    except CauseError:
        raise  # no fault of the file's
    except (ValueError, InputError) as error:
        raise source.error((), f"{error}; identify the model again") from error


def _knowledge(content: dict[str, Any], n_points: int) -> Knowledge:
    """Return what a model file keeps, in a form that has been checked, its sizes have not."""
    features, wander = _features(content["features"]), wander_from_mapping(content)
    if features.n_points != n_points:
        raise ValueError(
            f"features.n_points is {features.n_points}, the model's points are {n_points}"
        )
    own = {"gain_tilt": 1 + features.n_places, "held_back_rad_s": features.n_points}
    for name, n in own.items():
        if len(getattr(wander, name)) != n:
            raise ValueError(f"{name} has not {n} values")
    n_shapes = len(features.groups)
    mean = np.array(content["mean"], dtype=np.float64)
    if mean.size != n_shapes:
        raise ValueError(f"its {mean.size} shapes are not the {n_shapes} of this version")
    applied_effects(content["habits"])
    return Knowledge(
        noise_from_mapping(content["noise"]),
        features,
        mean,
        features.prior[:, None] * triangle_of(content["covariance_root"], n_shapes),
        wander,
        float(content["spikes_hz"]),
        tuple(content["habits"]),
    )


def _features(content: dict[str, Any]) -> Features:
    """Return the shapes that a model file keeps."""
    nodes_deg = tuple(float(node) for node in content["nodes_deg"])
    steepest_rad_s = content.get("steepest_rad_s")
    unmeasured_rad_s = content.get("unmeasured_rad_s", ())
    between_rad_s = content.get("between_rad_s", ())
    if np.any(np.diff(nodes_deg) <= 0.0):
        raise ValueError("features.nodes_deg does not rise")
    if len(unmeasured_rad_s) not in (0, len(nodes_deg)):
        raise ValueError("features.unmeasured_rad_s has not one value a node")
    if len(between_rad_s) not in (0, len(nodes_deg) - 1):
        raise ValueError("features.between_rad_s has not one value between two nodes")
    return Features(
        nodes_deg,
        float(content["top_rad_s"]),
        int(content["n_constants"]),
        int(content.get("n_points", 1)),
        int(content.get("n_places", 0)),
        None if steepest_rad_s is None else float(steepest_rad_s),
        tuple(float(off) for off in unmeasured_rad_s),
        tuple(float(off) for off in between_rad_s),
    )


def _cautious(model: HammersteinModel) -> Knowledge:
    """Values for a model of which nothing but its noise is known."""
    noise_rad_s = float(np.median([p.noise_rad_s for p in model.points]))
    low_deg = min(p.phase_range_deg[0] for p in model.points)
    high_deg = max(p.phase_range_deg[1] for p in model.points)
    table_deg = np.linspace(low_deg, high_deg, TABLED)
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
