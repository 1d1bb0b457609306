"""The default method: separable start, output-error refinement, knots at the dead zone's edges."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.curve_rows import CurveRows, curve_rows
from usmbench.identify.data import Dataset, describe
from usmbench.identify.design import build_design, check_rows
from usmbench.identify.dynamics import Dynamics, Family, FreeFamily, LagFamily
from usmbench.identify.gather import from_windows
from usmbench.identify.knots import dead_zone_deg, place_knots
from usmbench.identify.polish import polished
from usmbench.identify.residual_tests import residual_tests
from usmbench.identify.result import Identification, assemble
from usmbench.identify.robust import robust_fit
from usmbench.identify.selection import (
    DEGREES,
    Choice,
    choose_curve,
    fitted_curve,
    judge_knots,
    prior_rows,
)
from usmbench.identify.separable import separable_start
from usmbench.identify.torque_limit import limited_fit
from usmbench.identify.uncertainty import (
    Estimate,
    covariance,
    curve_intervals,
    dynamics_intervals,
)
from usmbench.model.hammerstein import StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]

_FIRST_DEGREE, _FIRST_STIFFNESS = 12, 1e-4
_MIDDLE_DEGREE = 18
_DEAD_TIMES = range(6)
_SEARCH_SHARE = 0.01  # of a long record: the better the curvature, the fewer passes over all
_SAME_EDGE = 0.005  # of the range of phases
_SEARCH_ROWS, _SEARCH_DWELLS = (4_000, 20_000), 800


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
    part = data.thinned(_search_rows(data))
    family, start, choices = _shape(part, options)
    knots_deg = [choice.knots_deg for choice, _ in choices]
    stretches = build_design(part, knots_deg)
    search = robust_fit(stretches, family, start, _priors(part, choices))
    share = part.n / data.n
    priors = [np.sqrt(share) * prior for prior in _priors(data, choices)]
    best = polished(data, knots_deg, family, search, priors)
    estimate = Estimate(family, best, search.problem.linearised(), share)
    if isinstance(family, LagFamily):
        estimate = limited_fit(stretches, search, family, best) or estimate
    curves = [StaticCurve(k, d) for k, d in zip(knots_deg, best.delta, strict=True)]
    spread = covariance(estimate, priors)
    intervals = {
        **dynamics_intervals(estimate, spread, data.window_s),
        "points": [curve_intervals(c, r) for c, r in zip(curves, spread.delta, strict=True)],
    }
    found = assemble(
        data,
        "fast",
        estimate.found.dynamics.linear_part(data.window_s),
        curves,
        intervals=intervals,
        colour=spread.noise_coefficients,
        tests=residual_tests(
            estimate.linearised, estimate.found.parameters.size, spread.noise_coefficients
        ),
    )
    warnings = (*found.warnings, *_few_phases(part, knots_deg))
    return replace(found, warnings=warnings, fit_s=time.perf_counter() - started_s)


def _priors(data: Dataset, choices: Sequence[tuple[Choice, CurveRows]]) -> list[Array]:
    """Rows of prior knowledge of each operating point's curve, beside these samples."""
    return [
        prior_rows(
            choice.knots_deg,
            choice.stiffness,
            rows.standing_deg,
            rows.stand_for(data.rows(point)),
        )
        for point, (choice, rows) in enumerate(choices)
    ]


def _search_rows(data: Dataset) -> int:
    """Rows that hold enough dwells to tell curves and dynamics; the rest only sharpens them."""
    fewest, most = _SEARCH_ROWS
    dwells = sum(1 + int(np.count_nonzero(np.diff(s.phase_deg))) for s in data.segments)
    wanted = _SEARCH_DWELLS * len(data.points) * data.n // dwells
    return min(max(wanted, fewest, int(_SEARCH_SHARE * data.n)), most)


def _few_phases(data: Dataset, knots_deg: Sequence[Array]) -> list[str]:
    """Warn of curves that fewer phases hold than they have ordinates."""
    warnings = []
    for point, knots in enumerate(knots_deg):
        phases = np.unique(data.phase_deg(point)).size
        if phases < knots.size:
            warnings.append(
                f"{data.name}: {phases} different phases{describe(data.points[point])} for "
                f"{knots.size} ordinates; between them the curve is smoothed, not measured"
            )
    return warnings


def _shape(
    data: Dataset, options: FastOptions
) -> tuple[Family, Array, list[tuple[Choice, CurveRows]]]:
    """Settle everything but the numbers: family of dynamics and a start in it, knots, stiffness."""
    nb = 2 if options.nb is None else options.nb
    points = range(len(data.points))
    degrees = [_degrees(data, point, options, nb) for point in points]
    even = [_even_knots(data, k, min(_FIRST_DEGREE, max(degrees[k]))) for k in points]
    stretches = build_design(data, even)
    priors = [prior_rows(even[k], _FIRST_STIFFNESS, None, data.rows(k)) for k in points]
    start = separable_start(stretches, options.na, nb, _DEAD_TIMES)
    family = _family(options, start)
    rough = robust_fit(stretches, family, family.parameters(start), priors).problem.fit
    rows = [curve_rows(data, k, rough) for k in points]
    choices = [
        _choice(rows[k], options, degrees[k], StaticCurve(even[k], rough.delta[k])) for k in points
    ]
    return family, rough.parameters, list(zip(choices, rows, strict=True))


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
    return place_knots(*data.spans_deg[point], degree)


def _choice(
    rows: CurveRows, options: FastOptions, degrees: Sequence[int], curve: StaticCurve
) -> Choice:
    """Choose a point's curve, twice: the first choice says better where it bends."""
    if options.knots_deg is not None:
        return judge_knots(rows, np.array(options.knots_deg, dtype=np.float64))
    span_deg = (float(curve.knots_deg[0]), float(curve.knots_deg[-1]))
    middling = min(degrees, key=lambda degree: abs(degree - _MIDDLE_DEGREE))
    first = choose_curve(rows, (middling,), _edges(curve), span_deg)
    edges_deg = _edges(fitted_curve(rows, first))
    if len(degrees) == 1 and _same_edges(edges_deg, _edges(curve), span_deg):
        return first
    return choose_curve(rows, degrees, edges_deg, span_deg)


def _same_edges(
    one_deg: tuple[float, ...], other_deg: tuple[float, ...], span_deg: tuple[float, float]
) -> bool:
    """Whether edges are where knots would be gathered at the same places."""
    return len(one_deg) == len(other_deg) and np.allclose(
        one_deg, other_deg, rtol=0.0, atol=_SAME_EDGE * (span_deg[1] - span_deg[0])
    )


def _edges(curve: StaticCurve) -> tuple[float, ...]:
    """Edges of a curve's dead zone, as far as it has any."""
    return tuple(edge for edge in dead_zone_deg(curve) if edge is not None)
