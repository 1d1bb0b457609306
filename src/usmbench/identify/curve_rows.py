"""The samples on which a curve is chosen, with what is held out when."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.between_levels import Levels
from usmbench.identify.data import Dataset, Segment
from usmbench.identify.dynamics import NONE, Dynamics
from usmbench.identify.like_phases import LEVELS, median_at_like_phases
from usmbench.identify.projected import Projected
from usmbench.identify.robust_fit import OVER_MEDIAN, bisquare_weights, residual_scales
from usmbench.model.linear import memory_windows

Array = NDArray[np.float64]

FOLDS = 5
_BLOCKS = 40
_MOST_ROWS = 4000
_FEWEST_DWELLS, _FEWEST_PHASES = 10, 10
_MOST_OF_THEM = 0.9  # phases of a staircase
_STANDING_SPEED = 0.002  # of the highest: less is standstill
_AGAIN, _REPEATS = 1.5, 0.005  # dwells a phase; of the highest speed
_BY_CHANCE = 3.0  # standard errors of a median: less is standstill, too
_WILD_SCALES, _WILD_SHARE = 10.0, 0.1  # of the residual's scale, of the highest speed


@dataclass(frozen=True, slots=True)
class CurveRows:
    """Samples that tell about one operating point's curve.

    Parameters
    ----------
    phase_deg, speed_rad_s
        Pieces of the record, or one piece of dwell medians.
    fold
        Fold of each sample; -1 where it is never held out, -2 where it is not used at all.
    dynamics
        What stands between curve and speed; the identity for dwell medians.
    weight
        Root of the weight of each sample, shaped as the speeds.
    standing_deg
        Lowest and highest phase about 0 at which a dwell stood; None where fewer than two did.
    scatter_rad_s
        Root mean square of samples about their mean at the same phase; no curve follows it.
    mean_error_rad_s
        Standard error of such a mean; infinite where blocks are held out, which drive the same
        phases as the others and say themselves whether a curve meets these.
    levels
        Between which levels the curve is held; None where it is free.
    """

    phase_deg: tuple[Array, ...]
    speed_rad_s: tuple[Array, ...]
    fold: tuple[NDArray[np.int64], ...]
    dynamics: Dynamics
    weight: tuple[Array, ...]
    standing_deg: tuple[float, float] | None = None
    scatter_rad_s: float = 0.0
    mean_error_rad_s: float = np.inf
    levels: Levels | None = None

    def stand_for(self, rows: int) -> int:
        """Return for how many rows of a record a smoothness chosen here holds.

        The median of a dwell is as sure as the dwell is long, so what is known keeps its share
        beside all rows of a record. Single rows are as noisy in a long record as here: there, what
        is known weighs no more than beside the rows it was chosen on.

        Parameters
        ----------
        rows
            Rows of the record at this operating point.
        """
        if self.dynamics is NONE:
            return rows
        return min(rows, sum(int(np.count_nonzero(fold >= 0)) for fold in self.fold))


def curve_rows(data: Dataset, point: int, rough: Projected) -> CurveRows:
    """Gather the samples on which a point's curve is chosen.

    Where dwells settle, at most of few phases or at ten of many, each gives its median settled
    speed, and neighbouring phases are held out together; else blocks of the record are held out.

    Parameters
    ----------
    data
        The samples.
    point
        Index of the operating point.
    rough
        A first fit to the same samples; what lies far off it is left out, and the noisier kind of
        its rows counts for less.
    """
    forget = memory_windows(rough.fit.dynamics.linear_part(None))
    phases, speeds, error_rad_s = _dwell_medians(data, point, forget)
    levels = np.unique(data.phase_deg(point)).size
    fewest = _MOST_OF_THEM * levels if levels <= LEVELS else _FEWEST_PHASES
    if phases.size >= _FEWEST_DWELLS and np.unique(phases).size >= fewest:
        fold, standing = _phase_folds(phases), _standing_deg(phases, speeds, error_rad_s)
        weight, scatter = np.ones(fold.size), _scatter(phases, speeds, error_rad_s)
        return CurveRows((phases,), (speeds,), (fold,), NONE, (weight,), standing, *scatter)
    return block_rows(data, point, rough)


def block_rows(
    data: Dataset, point: int, rough: Projected, most: int | None = _MOST_ROWS
) -> CurveRows:
    """Gather samples of which blocks of the record are held out.

    Parameters
    ----------
    data
        The samples.
    point
        Index of the operating point.
    rough
        As in `curve_rows`.
    most
        Rows at most, from the beginning of every stretch; None for all.
    """
    dynamics = rough.fit.dynamics
    forget = memory_windows(dynamics.linear_part(None))
    chosen = [k for k, s in enumerate(data.segments) if s.point == point]
    pieces = [data.segments[k] for k in chosen]
    wild = _wild([rough.fit.residual_rad_s[k] for k in chosen], pieces)
    # Those of the problem are of the round before its last.
    weights = bisquare_weights(rough, residual_scales(rough))
    total = sum(s.n for s in pieces)
    keep = 1.0 if most is None else min(1.0, most / total)
    cut = [max(forget + 1, int(s.n * keep)) for s in pieces]
    folds = []
    for k, (segment, n) in enumerate(zip(pieces, cut, strict=True)):
        n = min(n, segment.n)
        fold = (np.arange(n) * _BLOCKS // max(n, 1) + k) % FOLDS
        fold[: min(forget, n)] = -2
        fold[wild[k][:n]] = -2
        folds.append(fold)
    return CurveRows(
        tuple(s.phase_deg[: f.size] for s, f in zip(pieces, folds, strict=True)),
        tuple(s.speed_rad_s[: f.size] for s, f in zip(pieces, folds, strict=True)),
        tuple(folds),
        dynamics,
        tuple(1.0 / weights[k].spread[: f.size] for k, f in zip(chosen, folds, strict=True)),
    )


def _wild(residuals: Sequence[Array], pieces: Sequence[Segment]) -> list[NDArray[np.bool_]]:
    """Mark samples so far off that no curve explains them: further than a rough one's own error.

    Where those at about the same phase are off alike it is the rough curve that is: a dead zone
    that ends steeply.
    """
    every = np.concatenate(residuals)
    scale = OVER_MEDIAN * float(np.median(np.abs(every)))
    top = max(float(np.quantile(np.abs(s.speed_rad_s), 0.95)) for s in pieces)
    limit = max(_WILD_SCALES * scale, _WILD_SHARE * top)
    apart = every - median_at_like_phases(every, np.concatenate([s.phase_deg for s in pieces]))
    far = (np.abs(every) > limit) & (np.abs(apart) > limit)
    return np.split(far, np.cumsum([residual.size for residual in residuals])[:-1])


def _dwell_medians(data: Dataset, point: int, forget: int) -> tuple[Array, Array, float]:
    """Phase and median settled speed of every dwell that outlasts the memory; a median's error."""
    phases, speeds, errors = [], [], [0.0]
    for segment in (s for s in data.segments if s.point == point):
        starts = np.r_[0, np.flatnonzero(np.diff(segment.phase_deg)) + 1, segment.n]
        for first, last in pairwise(starts):
            if last - first > forget:
                settled_rad_s = segment.speed_rad_s[first + forget : last]
                phases.append(segment.phase_deg[first])
                speeds.append(np.median(settled_rad_s))
                errors.append(np.std(settled_rad_s) / np.sqrt(settled_rad_s.size))
    return np.array(phases), np.array(speeds), float(np.median(errors[1:] or errors))


def _scatter(phase_deg: Array, speed_rad_s: Array, error_rad_s: float) -> tuple[float, float]:
    """Scatter of dwells about their mean at the same phase, and a mean's standard error.

    Where hardly a phase comes twice, the motor is taken to repeat as motors do.
    """
    distinct, place, counts = np.unique(phase_deg, return_inverse=True, return_counts=True)
    means = np.bincount(place, weights=speed_rad_s) / counts
    scatter_rad_s = float(np.sqrt(np.mean((speed_rad_s - means[place]) ** 2)))
    each_rad_s = max(error_rad_s, scatter_rad_s)
    if phase_deg.size < _AGAIN * distinct.size:
        each_rad_s = max(each_rad_s, _REPEATS * float(np.max(np.abs(speed_rad_s))))
    return scatter_rad_s, each_rad_s * float(np.sqrt(distinct.size / phase_deg.size))


def _standing_deg(
    phase_deg: Array, speed_rad_s: Array, error_rad_s: float
) -> tuple[float, float] | None:
    """Return the ends of the run of standing dwells nearest to phase 0."""
    order = np.argsort(phase_deg)
    least_rad_s = max(
        _STANDING_SPEED * float(np.max(np.abs(speed_rad_s))), _BY_CHANCE * error_rad_s
    )
    standing = np.abs(speed_rad_s[order]) <= least_rad_s
    if not np.any(standing):
        return None
    sorted_deg = phase_deg[order]
    nearest = int(np.argmin(np.where(standing, np.abs(sorted_deg), np.inf)))
    below, above = np.flatnonzero(~standing[:nearest]), np.flatnonzero(~standing[nearest:])
    first = 0 if below.size == 0 else int(below[-1]) + 1
    last = standing.size - 1 if above.size == 0 else nearest + int(above[0]) - 1
    low_deg, high_deg = float(sorted_deg[first]), float(sorted_deg[last])
    return (low_deg, high_deg) if low_deg < high_deg else None


def _phase_folds(phase_deg: Array) -> NDArray[np.int64]:
    """Equal phases share a fold; the ends are never held out, nothing lies beyond them."""
    distinct, place = np.unique(phase_deg, return_inverse=True)
    fold_of = np.arange(distinct.size) % FOLDS
    fold_of[[0, -1]] = -1
    fold: NDArray[np.int64] = fold_of[place]
    return fold
