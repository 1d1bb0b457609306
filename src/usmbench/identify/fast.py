"""The default method: separable start, output-error refinement, knots at the dead zone's edges."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.data import Dataset, from_windows
from usmbench.identify.design import Stretch, build_design, check_rows
from usmbench.identify.dynamics import Dynamics, Family, FreeFamily, LagFamily
from usmbench.identify.knots import dead_zone_deg, place_knots
from usmbench.identify.output_error import Fit, fit_output_error
from usmbench.identify.result import Identification, assemble
from usmbench.identify.selection import (
    DEGREES,
    Choice,
    CurveRows,
    choose_curve,
    curve_rows,
    fitted_curve,
    judge_knots,
    prior_rows,
)
from usmbench.identify.separable import separable_start
from usmbench.model.hammerstein import StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]

_ROBUST_ROUNDS = 4
_BISQUARE = 4.685  # 95 % efficiency at the normal distribution (Huber and Ronchetti, 2009)
_FIRST_DEGREE, _FIRST_STIFFNESS = 12, 1e-4
_MIDDLE_DEGREE = 18
_DEAD_TIMES = range(6)


@dataclass(frozen=True, slots=True)
class FastOptions:
    """What the user fixed; None leaves the choice to the data.

    Parameters
    ----------
    degree
        Degree of the curves.
    knots_deg
        Knots of the curves; with knots given, the degree follows from them.
    na, nb
        Orders of the linear part.
    """

    degree: int | None = None
    knots_deg: tuple[float, ...] | None = None
    na: int = 1
    nb: int | None = None


def identify_fast(records: Sequence[Record], options: FastOptions) -> Identification:
    """Identify a model from the windows of one or several runs.

    Parameters
    ----------
    records
        The runs.
    options
        What is fixed.

    Raises
    ------
    InputError
        The data cannot carry the model; the message says why.
    """
    started_s = time.perf_counter()
    data = from_windows(records)
    nb = 2 if options.nb is None else options.nb
    points = range(len(data.points))
    degrees = [_degrees(data, point, options, nb) for point in points]
    even = [_even_knots(data, k, min(_FIRST_DEGREE, max(degrees[k]))) for k in points]
    stretches = build_design(data, even)
    pulls = [prior_rows(knots, _FIRST_STIFFNESS, None, data.n) for knots in even]
    start = separable_start(stretches, options.na, nb, _DEAD_TIMES)
    family = _family(options, start)
    rough = _robust_fit(stretches, family, family.parameters(start), pulls)
    rows = [curve_rows(data, k, rough.dynamics) for k in points]
    choices = [
        _choice(rows[k], options, degrees[k], StaticCurve(even[k], rough.delta[k])) for k in points
    ]
    stretches = build_design(data, [choice.knots_deg for choice in choices])
    pulls = [
        prior_rows(c.knots_deg, c.stiffness, r.standing_deg, data.n)
        for c, r in zip(choices, rows, strict=True)
    ]
    fit = _robust_fit(stretches, family, rough.parameters, pulls)
    curves = [StaticCurve(c.knots_deg, d) for c, d in zip(choices, fit.delta, strict=True)]
    linear = fit.dynamics.linear_part(data.window_s)
    return assemble(data, "fast", linear, curves, time.perf_counter() - started_s)


def _family(options: FastOptions, start: Dynamics) -> Family:
    """Search among lags with a dead time, unless the user asks for other orders."""
    if options.na == 1 and options.nb is None:
        return LagFamily(start.dead_time_windows + 2.0)
    return FreeFamily(start.a.size, start.beta.size, start.dead_time_windows)


def _degrees(data: Dataset, point: int, options: FastOptions, nb: int) -> tuple[int, ...]:
    """Degrees to choose from that the data can carry."""
    if options.knots_deg is not None:
        degrees: tuple[int, ...] = (len(options.knots_deg) - 1,)
    elif options.degree is not None:
        degrees = (options.degree,)
    else:
        phases = np.unique(data.phase_deg(point)).size
        degrees = tuple(d for d in DEGREES if d + 2 <= phases) or (min(DEGREES),)
    check_rows(data, min(degrees), options.na, nb, point=point)
    return degrees


def _even_knots(data: Dataset, point: int, degree: int) -> Array:
    """Even knots over a point's phases."""
    phase_deg = data.phase_deg(point)
    return place_knots(float(phase_deg.min()), float(phase_deg.max()), degree)


def _choice(
    rows: CurveRows, options: FastOptions, degrees: Sequence[int], curve: StaticCurve
) -> Choice:
    """Choose a point's curve, twice: the first choice says better where it bends."""
    if options.knots_deg is not None:
        return judge_knots(rows, np.array(options.knots_deg, dtype=np.float64))
    span_deg = (float(curve.knots_deg[0]), float(curve.knots_deg[-1]))
    middling = min(degrees, key=lambda degree: abs(degree - _MIDDLE_DEGREE))
    first = fitted_curve(rows, choose_curve(rows, (middling,), _edges(curve), span_deg))
    return choose_curve(rows, degrees, _edges(first), span_deg)


def _edges(curve: StaticCurve) -> tuple[float, ...]:
    """Edges of a curve's dead zone, as far as it has any."""
    return tuple(edge for edge in dead_zone_deg(curve) if edge is not None)


def _robust_fit(
    stretches: Sequence[Stretch], family: Family, start: Array, pulls: Sequence[Array]
) -> Fit:
    """Fit the free run, reweighting until neither outliers nor the noisier rows rule it.

    Windows just after a change of phase have a scale of their own: the moment of the command
    within its window, and dynamics that are none of a linear system, make them noisier.
    """
    changing = [_changing(s, family.dynamics(start)) for s in stretches]
    weights = [np.ones(s.speed_rad_s.size) for s in stretches]
    fit = fit_output_error(stretches, family, start, weights, pulls)
    for _ in range(_ROBUST_ROUNDS):
        residual, change = np.concatenate(fit.residual_rad_s), np.concatenate(changing)
        settled_rad_s, changing_rad_s = _scale(residual[~change]), _scale(residual[change])
        if settled_rad_s == 0.0 or changing_rad_s == 0.0:
            break
        base_rad_s = min(settled_rad_s, changing_rad_s)
        weights = []
        for r, c in zip(fit.residual_rad_s, changing, strict=True):
            scale = np.where(c, changing_rad_s, settled_rad_s)
            robust = np.clip(1.0 - (r / (_BISQUARE * scale)) ** 2, 0.0, 1.0)
            weights.append(robust * base_rad_s / scale)
        fit = fit_output_error(stretches, family, fit.parameters, weights, pulls)
    return fit


def _scale(residual: Array) -> float:
    """Return the standard deviation of the rows of one kind, by the median."""
    return 1.4826 * float(np.median(np.abs(residual))) if residual.size > 1 else 1.0


def _changing(stretch: Stretch, dynamics: Dynamics) -> NDArray[np.bool_]:
    """Rows on which a change of phase still acts."""
    changed = np.r_[True, np.any(np.diff(stretch.basis, axis=0) != 0.0, axis=1)]
    first, last = dynamics.dead_time_windows, dynamics.dead_time_windows + dynamics.beta.size
    recent = np.zeros(changed.size, dtype=np.bool_)
    for lag in range(first, last + 1):
        recent[lag:] |= changed[: changed.size - lag]
    return recent
