"""What an identification returns: the model, its scores, and the contract's JSON."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.data import Dataset, Segment
from usmbench.identify.knots import dead_zone_deg
from usmbench.model.hammerstein import (
    HammersteinModel,
    LinearPart,
    OperatingPoint,
    StaticCurve,
)
from usmbench.model.linear import (
    dead_time_s,
    delayed,
    fitted_start_rad_s,
    free_run,
    time_constant_s,
)

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Scores:
    """How well a model does on the samples of one operating point.

    Parameters
    ----------
    n
        Number of samples.
    sse
        Sum of squared one-step errors, eq. (16), in (rad/s)².
    rmse_one_step_rad_s, rmse_free_run_rad_s
        Root mean square of the one-step and of the free-running error.
    """

    n: int
    sse: float
    rmse_one_step_rad_s: float
    rmse_free_run_rad_s: float


@dataclass(frozen=True, slots=True)
class Identification:
    """A model, and how it came about.

    Parameters
    ----------
    model
        The model.
    scores
        One entry an operating point.
    warnings
        What the user ought to know, one sentence each.
    fit_s
        Time the identification took.
    """

    model: HammersteinModel
    scores: tuple[Scores, ...]
    warnings: tuple[str, ...]
    fit_s: float

    def to_json(self) -> dict[str, Any]:
        """Return the mapping that ``identify --json`` writes."""
        n = sum(score.n for score in self.scores)
        points = [self._point_json(k) for k in range(len(self.scores))]
        head = {"method": self.model.method, "n": n}
        tail = {"fit_s": self.fit_s, "warnings": list(self.warnings)}
        if len(points) > 1:
            return {**head, "points": points, **tail}
        return {**points[0], **head, **tail}

    def _point_json(self, k: int) -> dict[str, Any]:
        """One operating point's part."""
        point, score, linear = self.model.points[k], self.scores[k], self.model.linear
        return {
            "frequency_hz": point.frequency_hz,
            "torque_nm": point.torque_nm,
            "n": score.n,
            "sse": score.sse,
            "rmse_one_step_rad_s": score.rmse_one_step_rad_s,
            "rmse_free_run_rad_s": score.rmse_free_run_rad_s,
            "a": linear.a.tolist(),
            "b": linear.b.tolist(),
            "delta": point.curve.delta.tolist(),
            "knots_deg": point.curve.knots_deg.tolist(),
            "tau_s": time_constant_s(linear),
            "gain_linear": linear.gain,
            "dead_zone_deg": list(point.dead_zone_deg),
            "dead_time_s": dead_time_s(linear),
            "dead_time_windows": linear.dead_time_windows,
        }


def assemble(
    data: Dataset,
    method: str,
    linear: LinearPart,
    curves: Sequence[StaticCurve],
    fit_s: float,
) -> Identification:
    """Make a model of estimates, and score it on the samples it was fitted on.

    Parameters
    ----------
    data
        The samples.
    method
        "paper" or "fast".
    linear
        The estimated dynamics.
    curves
        The estimated curve of each operating point.
    fit_s
        Time the estimation took.
    """
    points, scores = [], []
    for k, ((frequency_hz, torque_nm), curve) in enumerate(zip(data.points, curves, strict=True)):
        score = _score(data, linear, curve, k)
        phase_deg = data.phase_deg(k)
        points.append(
            OperatingPoint(
                frequency_hz,
                torque_nm,
                curve,
                (float(phase_deg.min()), float(phase_deg.max())),
                dead_zone_deg(curve),
                score.rmse_free_run_rad_s,
            )
        )
        scores.append(score)
    total = sum(s.n for s in scores)
    free = float(np.sqrt(sum(s.n * s.rmse_free_run_rad_s**2 for s in scores) / total))
    one = float(np.sqrt(sum(s.n * s.rmse_one_step_rad_s**2 for s in scores) / total))
    model = HammersteinModel(
        linear,
        tuple(points),
        method,
        fitted_on=tuple({"name": name} for name in data.run_names),
        residual={"rmse_free_run_rad_s": free, "rmse_one_step_rad_s": one, "n": total},
    )
    return Identification(model, tuple(scores), data.warnings, fit_s)


def _score(data: Dataset, linear: LinearPart, curve: StaticCurve, point: int) -> Scores:
    """One-step and free-running errors over a point's segments."""
    mine = [s for s in data.segments if s.point == point]
    one_step = np.concatenate([_one_step_error(linear, curve, s) for s in mine])
    free = np.concatenate([_free_run_error(linear, curve, s) for s in mine])
    return Scores(
        free.size,
        float(np.sum(one_step**2)),
        float(np.sqrt(np.mean(one_step**2))),
        float(np.sqrt(np.mean(free**2))),
    )


def _free_run_error(linear: LinearPart, curve: StaticCurve, segment: Segment) -> Array:
    """Measured minus free-running speed, from the start that suits the segment best."""
    settled_rad_s = curve.speed_rad_s(segment.phase_deg)
    start_rad_s = fitted_start_rad_s(linear, settled_rad_s, segment.speed_rad_s)
    return segment.speed_rad_s - free_run(linear, settled_rad_s, start_rad_s)


def _one_step_error(linear: LinearPart, curve: StaticCurve, segment: Segment) -> Array:
    """Measured minus predicted from measured past speeds, on rows that have a whole past."""
    settled_rad_s = curve.speed_rad_s(segment.phase_deg)
    predicted = np.zeros(segment.n)
    for k, b in enumerate(linear.b, start=linear.dead_time_windows):
        predicted += b * delayed(settled_rad_s, k, settled_rad_s[0])
    for i, a in enumerate(linear.a, start=1):
        predicted -= a * delayed(segment.speed_rad_s, i)
    first = min(max(linear.a.size, linear.dead_time_windows + linear.b.size - 1), segment.n - 1)
    return (segment.speed_rad_s - predicted)[first:]
