"""What an identification returns: the model, its scores, and the contract's JSON."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.data import Dataset
from usmbench.identify.knots import dead_zone_deg
from usmbench.identify.pieces import Piece, pieces, settled_speed_rad_s
from usmbench.identify.residual_tests import ResidualTest
from usmbench.model.effects.first_order import true_dead_time_s
from usmbench.model.hammerstein import (
    HammersteinModel,
    LinearPart,
    OperatingPoint,
    StaticCurve,
)
from usmbench.model.linear import (
    delayed,
    free_run,
    time_constant_s,
)

Array = NDArray[np.float64]

_SIGNIFICANT = 0.01


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
    tests
        Tests of the residual.
    fit_s
        Time the identification took.
    """

    model: HammersteinModel
    scores: tuple[Scores, ...]
    warnings: tuple[str, ...]
    tests: tuple[ResidualTest, ...] = ()
    fit_s: float = 0.0

    def to_json(self) -> dict[str, Any]:
        """Return the mapping that ``identify --json`` writes."""
        n = sum(score.n for score in self.scores)
        points = [self._point_json(k) for k in range(len(self.scores))]
        head = {"method": self.model.method, "n": n}
        tail: dict[str, Any] = {"fit_s": self.fit_s, "warnings": list(self.warnings)}
        if self.tests:
            tail["residual_tests"] = [asdict(test) for test in self.tests]
        shared = {k: v for k, v in self.model.intervals.items() if k != "points"}
        if shared:
            tail["intervals"] = shared
        if len(points) > 1:
            return {**head, "points": points, **tail}
        return {**points[0], **head, **tail}

    def _point_json(self, k: int) -> dict[str, Any]:
        """One operating point's part."""
        point, score, linear = self.model.points[k], self.scores[k], self.model.linear
        own = self.model.intervals.get("points")
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
            "dead_time_s": true_dead_time_s(linear),
            "dead_time_windows": linear.dead_time_windows,
            "slip_limit_rad_s": linear.slip_limit_rad_s,
            **({} if own is None else {"curve_intervals": own[k]}),
        }


def assemble(
    data: Dataset,
    method: str,
    linear: LinearPart,
    curves: Sequence[StaticCurve],
    *,
    intervals: dict[str, Any] | None = None,
    colour: Array | None = None,
    tests: Sequence[ResidualTest] = (),
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
    intervals
        95 % intervals, where the method gives them: ``a``, ``b``, ``tau_s``, ``dead_time_s``, and
        a mapping an operating point under ``points``.
    colour
        Autoregressive coefficients of the residual, where the method gives them.
    tests
        Tests of the residual; one that rejects is kept in the model as structure it lacks.
    """
    points, scores = [], []
    for k, ((frequency_hz, torque_nm), curve) in enumerate(zip(data.points, curves, strict=True)):
        score = _score(data, linear, curve, k)
        points.append(
            OperatingPoint(
                frequency_hz,
                torque_nm,
                curve,
                data.spans_deg[k],
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
        fitted_on=tuple(asdict(run) for run in data.runs),
        residual={
            "rmse_free_run_rad_s": free,
            "rmse_one_step_rad_s": one,
            "n": total,
            "noise_ar": [] if colour is None else colour.tolist(),
        },
        unexplained=tuple(asdict(test) for test in tests if test.p_value < _SIGNIFICANT),
        intervals=intervals or {},
    )
    return Identification(model, tuple(scores), data.warnings, tuple(tests))


def _score(data: Dataset, linear: LinearPart, curve: StaticCurve, point: int) -> Scores:
    """One-step and free-running errors over a point's segments, in pieces."""
    squares, n, n_one_step = np.zeros(2), 0, 0
    for piece in pieces(data, linear, point):
        settled_rad_s = settled_speed_rad_s(piece.phase_deg, curve)
        one_step = _one_step_error(linear, settled_rad_s, piece)
        free = _free_run_error(linear, settled_rad_s, piece)
        squares += one_step @ one_step, free @ free
        n, n_one_step = n + free.size, n_one_step + one_step.size
    one_step_sse, free_sse = squares.tolist()
    return Scores(
        n,
        one_step_sse,
        math.sqrt(one_step_sse / max(n_one_step, 1)),
        math.sqrt(free_sse / n),
    )


def _free_run_error(linear: LinearPart, settled_rad_s: Array, piece: Piece) -> Array:
    """Measured minus free-running speed, from the start that suits the measurement best."""
    start_rad_s = piece.start_rad_s(linear, settled_rad_s)
    return (piece.speed_rad_s - free_run(linear, settled_rad_s, start_rad_s))[piece.before :]


def _one_step_error(linear: LinearPart, settled_rad_s: Array, piece: Piece) -> Array:
    """Measured minus predicted from measured past speeds, on rows that have a whole past."""
    speed_rad_s = piece.speed_rad_s
    late = delayed(settled_rad_s, linear.dead_time_windows, settled_rad_s[0])
    predicted = np.zeros(speed_rad_s.size)
    for k, b in enumerate(linear.b):
        predicted += b * delayed(late, k, settled_rad_s[0])
    for i, a in enumerate(linear.a, start=1):
        predicted -= a * delayed(speed_rad_s, i)
    past = max(linear.a.size, linear.dead_time_windows + linear.b.size - 1)
    return (speed_rad_s - predicted)[max(piece.before, past) :]
