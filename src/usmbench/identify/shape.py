"""What a fit settles before its numbers: family and start of the dynamics, knots, smoothness."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.curve_rows import CurveRows, curve_rows
from usmbench.identify.data import Dataset
from usmbench.identify.design import build_design, check_rows
from usmbench.identify.dynamics import (
    LONGER_DEAD_TIME,
    Dynamics,
    Family,
    FreeFamily,
    LagFamily,
)
from usmbench.identify.knots import dead_zone_deg, knees_deg, place_knots
from usmbench.identify.output_error import fit_output_error
from usmbench.identify.projected import Projected
from usmbench.identify.robust import bisquare_weights, counted_alike, residual_scales, robust_fit
from usmbench.identify.selection import (
    DEGREES,
    Choice,
    choose_curve,
    fitted_curve,
    judge_knots,
    prior_rows,
)
from usmbench.identify.separable import separable_start
from usmbench.identify.thinning import thinned
from usmbench.model.hammerstein import StaticCurve

Array = NDArray[np.float64]
Bends = tuple[tuple[float, ...], ...]

_FIRST_DEGREE, _FIRST_STIFFNESS = 12, 1e-4
_FEW, _FEW_ROWS = 4, 500  # the first dynamics rest on every fourth row, in blocks
_FIRST_TOLERANCE, _FINE_TOLERANCE = 0.02, 1e-3  # of the sum of squares
_PLAINLY, _PLAIN_SHARE = 50.0, 0.03  # deviance, share of it: other windows fit better by more
_MIDDLE_DEGREE = 18
_DEAD_TIMES = range(6)
_SAME_BEND = 0.005  # of the range of phases


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


@dataclass(frozen=True, slots=True)
class Shape:
    """Everything but the numbers.

    Parameters
    ----------
    rough
        A first fit, to the knots given or to even ones.
    given
        Whether the knots were given.
    choices
        Knots and smoothness of each operating point's curve.
    rows
        The samples on which each was chosen.
    """

    rough: Projected
    given: bool
    choices: Sequence[Choice]
    rows: Sequence[CurveRows]

    @property
    def knots_deg(self) -> list[Array]:
        """Knots of each operating point's curve."""
        return [choice.knots_deg for choice in self.choices]

    def priors(self, data: Dataset) -> list[Array]:
        """Return rows of prior knowledge of each operating point's curve, beside some samples.

        Parameters
        ----------
        data
            The samples.
        """
        return [
            prior_rows(
                choice.knots_deg,
                choice.stiffness,
                rows.standing_deg,
                rows.stand_for(data.rows(point)),
            )
            for point, (choice, rows) in enumerate(zip(self.choices, self.rows, strict=True))
        ]

    def problem(self, part: Dataset) -> Projected:
        """Return the problem to start the search from.

        Parameters
        ----------
        part
            The samples on which the shape was settled.
        """
        alike, priors = self.rough, self.priors(part)
        if not self.given:
            # Rough weights would hide the rows that the rough curve missed.
            stretches, start = build_design(part, self.knots_deg), self.rough.fit.parameters
            counted = counted_alike(stretches)
            # Weights of dynamics that miss every change of phase would hide the changes.
            alike = _from_afar(Projected(stretches, self.rough.family, start, counted, priors))
            alike = _or_sampled(alike)
        return alike.reweighted(bisquare_weights(alike, residual_scales(alike)), priors)


def settle_shape(data: Dataset, part: Dataset, options: FastOptions) -> Shape:
    """Settle what the user left open, on held-out samples.

    Parameters
    ----------
    data
        All samples.
    part
        Those to settle it on.
    options
        What is fixed.

    Raises
    ------
    InputError
        The data cannot carry the model.
    """
    nb = 2 if options.nb is None else options.nb
    points = range(len(part.points))
    degrees = [_degrees(part, point, options, nb) for point in points]
    even = [place_knots(*part.spans_deg[k], min(_FIRST_DEGREE, max(degrees[k]))) for k in points]
    family, start = _first_dynamics(thinned(data, part.n // _FEW, _FEW_ROWS), even, options, nb)
    given = options.knots_deg
    knots_deg = even if given is None else [np.array(given, dtype=np.float64)] * len(points)
    stretches = build_design(part, knots_deg)
    alike = counted_alike(stretches)
    rough = Projected(stretches, family, start, alike, _soft(part, knots_deg))
    if given is None:
        rough = robust_fit(rough).problem
    rows = [curve_rows(part, k, rough.fit) for k in points]
    choices = [
        _choice(rows[k], options, degrees[k], StaticCurve(knots_deg[k], rough.fit.delta[k]))
        for k in points
    ]
    return Shape(rough, given is not None, choices, rows)


def _first_dynamics(
    data: Dataset, knots_deg: Sequence[Array], options: FastOptions, nb: int
) -> tuple[Family, Array]:
    """Dynamics to start the search from, and their family."""
    stretches = build_design(data, knots_deg)
    separable = separable_start(stretches, options.na, nb, _DEAD_TIMES)
    family, alike = _family(options, separable), counted_alike(stretches)
    start = family.parameters(separable)
    problem = Projected(stretches, family, start, alike, _soft(data, knots_deg))
    found = _or_sampled(_from_afar(problem))
    return found.family, found.fit.parameters


def _from_afar(start: Projected) -> Projected:
    """Roughly fit the dynamics from here and from the best of lags short and long.

    Rows that a rough curve misses look like a lag of another length, or like a dead time.
    """
    here = fit_output_error(start, _FIRST_TOLERANCE)
    if not isinstance(start.family, LagFamily):
        return here
    others = [start.at(parameters) for parameters in start.family.starts()]
    best = min(others, key=lambda other: other.fit.sse)
    return min(here, fit_output_error(best, _FIRST_TOLERANCE), key=lambda found: found.fit.sse)


def _or_sampled(averaged: Projected) -> Projected:
    """Return the same problem for speeds at the ends of windows, where these plainly fit better.

    Other benches sample a tachometer, and simulations by the paper's equation have no windows.
    """
    if not isinstance(averaged.family, LagFamily) or averaged.family.sampled:
        return averaged
    start, family = averaged.fit.parameters, replace(averaged.family, sampled=True)
    sampled = fit_output_error(
        Projected(averaged.stretches, family, start, averaged.weights, averaged.penalties),
        _FINE_TOLERANCE,
    )
    gained = averaged.fit.sse - sampled.fit.sse
    # Without noise there is no scale to speak of.
    mean_square = sampled.fit.sse / sum(s.speed_rad_s.size for s in sampled.stretches)
    square = min(min(residual_scales(sampled)) ** 2, mean_square)
    least = max(_PLAINLY * square, _PLAIN_SHARE * averaged.fit.sse)
    return sampled if gained > least else averaged


def _soft(data: Dataset, knots_deg: Sequence[Array]) -> list[Array]:
    """Rows of prior knowledge of curves that nothing is known of yet."""
    return [
        prior_rows(knots, _FIRST_STIFFNESS, None, data.rows(point))
        for point, knots in enumerate(knots_deg)
    ]


def _family(options: FastOptions, start: Dynamics) -> Family:
    """Search among lags with a dead time, unless the user asks for other orders."""
    if options.na == 1 and options.nb is None:
        return LagFamily(start.dead_time_windows + LONGER_DEAD_TIME)
    return FreeFamily(start.a.size, start.beta.size, start.dead_time_windows)


def _degrees(data: Dataset, point: int, options: FastOptions, nb: int) -> tuple[int, ...]:
    """Degrees to choose from that the data can carry."""
    if options.knots_deg is not None:
        degrees: tuple[int, ...] = (len(options.knots_deg) - 1,)
    elif options.degree is not None:
        degrees = (options.degree,)
    else:
        phases = np.unique(data.phase_deg(point)).size
        degrees = tuple(d for d in DEGREES if d < phases) or (min(DEGREES),)
    check_rows(data, min(degrees), options.na, nb, point=point)
    return degrees


def _choice(
    rows: CurveRows, options: FastOptions, degrees: Sequence[int], curve: StaticCurve
) -> Choice:
    """Choose a point's curve, twice: the first choice says better where it bends."""
    if options.knots_deg is not None:
        return judge_knots(rows, np.array(options.knots_deg, dtype=np.float64))
    span_deg = (float(curve.knots_deg[0]), float(curve.knots_deg[-1]))
    middling = min(degrees, key=lambda degree: abs(degree - _MIDDLE_DEGREE))
    first = choose_curve(rows, (middling,), _bends(curve), span_deg)
    bends_deg = _bends(fitted_curve(rows, first))
    if len(degrees) == 1 and _same_bends(bends_deg, _bends(curve), span_deg):
        return first
    return choose_curve(rows, degrees, bends_deg, span_deg)


def _same_bends(one_deg: Bends, other_deg: Bends, span_deg: tuple[float, float]) -> bool:
    """Whether knots would be gathered at the same places."""
    one, other = (sum(bends, ()) for bends in (one_deg, other_deg))
    return len(one) == len(other) and np.allclose(
        one, other, rtol=0.0, atol=_SAME_BEND * (span_deg[1] - span_deg[0])
    )


def _bends(curve: StaticCurve) -> Bends:
    """Edges of a curve's dead zone, as far as it has any, and these with where it saturates."""
    edges_deg = tuple(edge for edge in dead_zone_deg(curve) if edge is not None)
    knees = knees_deg(curve, edges_deg)
    return tuple(bends for bends in (edges_deg, edges_deg + knees if knees else ()) if bends)
