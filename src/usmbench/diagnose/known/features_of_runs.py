"""The family of shapes for given runs: where its nodes lie, and how large its scales are."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.cutting.warmth import n_constants
from usmbench.diagnose.known.features import Features
from usmbench.diagnose.known.gaps import Gaps
from usmbench.diagnose.known.phase_nodes import TABLED, phase_nodes
from usmbench.diagnose.known.unmeasured import (
    by_chance_rad_s,
    short_of_ends_deg,
    unheld_rad_s,
)
from usmbench.model.effects.context import longest_s

Array = NDArray[np.float64]


def features_of(stretches: Sequence[Stretch]) -> Features:
    """Return the family for the runs that a model was identified on.

    Parameters
    ----------
    stretches
        The runs.
    """
    phase_deg = [s.context.phase_deg for s in stretches]
    table_deg = np.linspace(
        min(p.min() for p in phase_deg), max(p.max() for p in phase_deg), TABLED
    )
    speeds = [_at_point(stretches, k, table_deg) for k in range(len(stretches[0].points))]
    every_deg = np.sort(np.concatenate(phase_deg))
    measured_deg = np.unique(every_deg)
    nodes_deg = phase_nodes(table_deg, speeds, measured_deg, short_of_ends_deg(measured_deg))
    nodes, gaps = np.array(nodes_deg), Gaps.of(measured_deg, table_deg, speeds)
    top_rad_s = max(max(float(np.max(np.abs(s.settled_rad_s))) for s in stretches), 1e-9)
    at_ends = unheld_rad_s(nodes_deg, every_deg, top_rad_s)
    used_deg, left, *points = (
        np.concatenate([part[s.use] for part, s in zip(parts, stretches, strict=True)])
        for parts in (
            phase_deg,
            [s.residual_rad_s for s in stretches],
            *zip(*(s.points for s in stretches), strict=True),
        )
    )
    few = by_chance_rad_s(nodes_deg, used_deg, points, left)
    unmeasured = np.linalg.norm([gaps.at_nodes_rad_s(nodes), at_ends, few], axis=0)
    return Features(
        nodes_deg,
        top_rad_s,
        n_constants(longest_s([s.context for s in stretches])),
        len(stretches[0].points),
        len(stretches[0].places),
        _steepest_rad_s(stretches),
        _rounded(unmeasured),
        _rounded(gaps.between_nodes_rad_s(nodes)),
    )


def _rounded(off_rad_s: Array) -> tuple[float, ...]:
    """Numbers as a file keeps them."""
    return tuple(float(f"{off:.4g}") for off in off_rad_s)


def _at_point(stretches: Sequence[Stretch], point: int, phase_deg: Array) -> Array:
    """Settled speeds at phases at the rows that are nearest to an operating point."""
    nearest = max(stretches, key=lambda s: float(np.sum(s.points[point])))
    rows = np.argsort(-nearest.points[point], kind="stable")[: max(nearest.context.n // 4, 1)]
    speeds = []
    for part in np.array_split(phase_deg, -(-phase_deg.size // rows.size)):
        asked_deg = nearest.context.phase_deg.copy()
        asked_deg[rows[: part.size]] = part
        speeds.append(nearest.context.settled_rad_s(asked_deg)[rows[: part.size]])
    return np.concatenate(speeds)


def _steepest_rad_s(stretches: Sequence[Stretch]) -> float | None:
    """Largest change of the speed with the relative drive frequency, where it is known."""
    changes = [
        float(np.max(np.abs(s.context.detuning_rad_s(s.context.phase_deg))))
        for s in stretches
        if s.context.detuning_rad_s is not None
    ]
    return max(changes) if changes and min(changes) > 0.0 else None
