"""Do large steps take longer than small ones? The slip at which the motor's torque gives out.

The curves stay as the linear fit left them, on settled windows. The free run with a torque limit
(`usmbench.model.torque_limit`) then has three parameters. It is fitted beside the plain lag on one
half of the record's dwells and both are scored on the other half, and the other way round; the
limit is taken where it leaves clearly less just after changes of phase. One large step alone shows
none: no half foretells it, and a command that met its window late looks the same.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.courses import Course, courses_of, fitted_dynamics, scaled_residual
from usmbench.identify.design import Stretch
from usmbench.identify.dynamics import Dynamics, Parametrised
from usmbench.identify.lag_family import LagFamily
from usmbench.identify.linearised import Linearisation, Linearised
from usmbench.identify.polish import Polished
from usmbench.identify.robust_fit import RobustFit, bisquare_root, changing_rows, scales
from usmbench.identify.row_weights import RowWeights
from usmbench.identify.uncertainty import Estimate
from usmbench.model.linear import fading, fitted_start_rad_s, free_run

Array = NDArray[np.float64]

_JUDGED_ROWS = (2500, 200)  # in all, and of each stretch
_FEWEST_CHANGES = 20  # rows just after a change, in each half
_HINT = 5.0  # standard deviations
_CLEARLY = 0.9  # of the lag's loss
_AS_LARGE = 0.5  # of a step, for one to teach of it
_LOW, _HIGH = 0.02, 50.0  # slips of interest, of the span of speeds
_NUDGE = 1e-4


@dataclass(frozen=True, slots=True)
class LimitedLagFamily:
    """Lags with a torque limit; the parameters are those of the lag, then the logarithm of s.

    Parameters
    ----------
    lag
        The lags.
    span_rad_s
        Difference between the highest and the lowest speed.
    """

    lag: LagFamily
    span_rad_s: float

    def dynamics(self, parameters: Array) -> Dynamics:
        """Return the dynamics.

        Parameters
        ----------
        parameters
            ln(τ/T), dead time over T, ln s, shape (3,).
        """
        limit_rad_s = math.exp(parameters[2])
        return replace(self.lag.dynamics(parameters[:2]), slip_limit_rad_s=limit_rad_s)

    def beside(self, lag: Array) -> Array:
        """Return a lag's parameters with a limit that its largest steps would feel.

        Parameters
        ----------
        lag
            Parameters of the lag, shape (2,).
        """
        return self.moved(np.r_[lag, math.log(0.5 * self.span_rad_s)], np.zeros(3))

    def moved(self, parameters: Array, step: Array) -> Array:
        """Return the sum, with every parameter kept in its bounds.

        A run with a limit comes no sooner than its commands: below 0 nothing would change, and a
        search that begins there stays.

        Parameters
        ----------
        parameters, step
            Where from and how far, shape (3,).
        """
        low, high = (math.log(share * self.span_rad_s) for share in (_LOW, _HIGH))
        slip = min(max(float(parameters[2] + step[2]), low), high)
        lag, dead = self.lag.moved(parameters[:2], step[:2])
        return np.array([lag, max(dead, 0.0), slip])


def limited_fit(search: RobustFit, lag: LagFamily, found: Polished) -> Estimate | None:
    """Return the estimate with a torque limit, or None where the data do not ask for one.

    Parameters
    ----------
    search
        The linear fit.
    lag
        Its family.
    found
        The estimates it came to.
    """
    stretches = search.problem.stretches
    courses = courses_of(stretches, found)
    rows = max(_JUDGED_ROWS[0], _JUDGED_ROWS[1] * len(courses))
    share = min(1.0, rows / sum(c.half.size for c in courses))
    judged = [course.beginning(share) for course in courses]
    speeds = np.concatenate([c.settled_rad_s for c in judged])
    halves = np.concatenate([c.half[c.changing & (c.half >= 0)] for c in judged])
    changes = int(np.bincount(halves, minlength=2).min())
    if changes < _FEWEST_CHANGES or np.ptp(speeds) == 0.0 or search.quietest_rad_s == 0.0:
        return None
    family = LimitedLagFamily(lag, float(np.ptp(speeds)))
    scale = (search.settled_rad_s, search.changing_rad_s)
    start = family.beside(found.parameters)
    if not (_hinted(judged, family, start, scale) and _better(judged, family, start, scale)):
        return None
    parameters = fitted_dynamics(judged, family, start, scale)
    left = scaled_residual(judged, family, parameters, (1.0, 1.0), (0, 1))
    counted = np.concatenate([c.changing[c.half >= 0] for c in judged])
    parameters = fitted_dynamics(courses, family, parameters, scales(left, counted))
    limited = Polished(parameters, family.dynamics(parameters), found.delta)
    return Estimate(family, limited, _linearised(stretches, family, limited), 1.0)


def _hinted(
    courses: Sequence[Course], family: LimitedLagFamily, start: Array, scale: tuple[float, float]
) -> bool:
    """Score test: whether what a limit would change explains some of what the lag leaves."""
    lag, whole = start[:2], (0, 1)
    left = scaled_residual(courses, family.lag, lag, scale, whole)
    if _as_quiet_as_settled(courses, left, scale):
        return False
    moves = []
    for nudge in np.eye(2):
        nudged = family.lag.moved(lag, _NUDGE * nudge)
        moves.append(scaled_residual(courses, family.lag, nudged, scale, whole) - left)
    moves.append(scaled_residual(courses, family, start, scale, whole) - left)
    columns = np.column_stack(moves)
    root = (1.0 + left**2) ** -0.25  # of the weights in the loss: large steps miss by much
    columns *= (root / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)[:, None]).T
    q, r = np.linalg.qr(columns)
    return abs(float(r[-1, -1])) > _NUDGE and abs(float(q[:, -1] @ (root * left))) > _HINT


def _as_quiet_as_settled(
    courses: Sequence[Course], left: Array, scale: tuple[float, float]
) -> bool:
    """Whether changes of phase leave no more than what noise leaves away from them."""
    changing = np.concatenate([c.changing[c.half >= 0] for c in courses])
    settled = ~changing
    if np.count_nonzero(settled) < _FEWEST_CHANGES:
        return False
    return _CLEARLY * _loss(left[changing] * scale[1] / scale[0]) < _loss(left[settled])


def _loss(left: Array) -> float:
    """Mean loss of scaled residuals: squares of small ones, sizes of large ones."""
    return float(np.mean(np.sqrt(1.0 + left**2) - 1.0))


def _better(
    courses: Sequence[Course], family: LimitedLagFamily, start: Array, scale: tuple[float, float]
) -> bool:
    """Whether the limit leaves clearly less on the dwells held out."""
    if _AS_LARGE * _largest_rad_s(courses, 0) > _largest_rad_s(courses, 1):
        return False
    losses = [0.0, 0.0]
    candidates: tuple[tuple[Parametrised, Array], ...] = ((family.lag, start[:2]), (family, start))
    for k, (candidate, begin) in enumerate(candidates):
        for trained, held_out in ((0, 1), (1, 0)):
            parameters = fitted_dynamics(courses, candidate, begin, scale, (trained,))
            left = scaled_residual(
                courses, candidate, parameters, scale, (held_out,), changing=True
            )
            losses[k] += left.size * _loss(left)
    return losses[1] < _CLEARLY * losses[0]


def _largest_rad_s(courses: Sequence[Course], half: int) -> float:
    """Size of the largest step of one half of the dwells; of all it is in the first."""
    return max(float(np.max(np.abs(c.step_rad_s[c.half == half]), initial=0.0)) for c in courses)


def _linearised(
    stretches: Sequence[Stretch], family: LimitedLagFamily, found: Polished
) -> Linearisation:
    """Linearise the free run of every stretch; by the curves' ordinates as for small steps."""
    dynamics, linear = found.dynamics, found.dynamics.linear_part(1.0)
    runs, slopes, changing = [], [], []
    for s in stretches:
        settled_rad_s = s.basis @ found.delta[s.point]
        start_rad_s = fitted_start_rad_s(linear, settled_rad_s, s.speed_rad_s)
        run = free_run(linear, settled_rad_s, start_rad_s)
        moved = [_nudged(family, found.parameters, k) for k in range(3)]
        slopes.append(
            [
                (free_run(family.dynamics(p).linear_part(1.0), settled_rad_s, start_rad_s) - run)
                / (p - found.parameters)[k]
                for k, p in enumerate(moved)
            ]
        )
        runs.append(run)
        changing.append(changing_rows(s.phase_deg, dynamics))
    left = [s.speed_rad_s - run for s, run in zip(stretches, runs, strict=True)]
    settled, moving = scales(np.concatenate(left), np.concatenate(changing))
    pieces = []
    for s, residual, own, change in zip(stretches, left, slopes, changing, strict=True):
        scale = np.where(change, moving, settled)
        pieces.append(
            Linearised.of(
                np.column_stack([dynamics.respond(s.basis), *own]),
                fading(dynamics.numerator, dynamics.a, dynamics.dead_time_windows, residual.size),
                RowWeights(scale / min(settled, moving), bisquare_root(residual / scale)),
                residual,
                s.basis @ found.delta[s.point],
                s.point,
            )
        )
    return Linearisation(pieces)


def _nudged(family: LimitedLagFamily, parameters: Array, k: int) -> Array:
    """Return parameters of which one is a little larger, or smaller where it is at its largest."""
    nudge = _NUDGE * np.eye(parameters.size)[k]
    more = family.moved(parameters, nudge)
    return more if more[k] > parameters[k] else family.moved(parameters, -nudge)
