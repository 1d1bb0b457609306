"""What a fit settles before its numbers: family and start of the dynamics, knots, smoothness."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.bends import bends_of_curve, bends_of_rows, joined
from usmbench.identify.between_levels import Levels
from usmbench.identify.curve_rows import LEVELS, CurveRows, block_rows, curve_rows
from usmbench.identify.data import Dataset
from usmbench.identify.design import build_design, check_rows
from usmbench.identify.dynamics import NONE
from usmbench.identify.jumping_curve import jumping_choice
from usmbench.identify.knots import place_knots
from usmbench.identify.projected import Projected
from usmbench.identify.robust_fit import (
    bisquare_weights,
    counted_alike,
    residual_scales,
    robust_fit,
)
from usmbench.identify.selection import (
    DEGREES,
    Choice,
    better,
    choose_curve,
    fitted_curve,
    judge_knots,
    prior_rows,
)
from usmbench.identify.starting_dynamics import (
    first_dynamics,
    fit_from_afar,
    or_sampled,
    soft_priors,
)
from usmbench.identify.thinning import thinned

Array = NDArray[np.float64]

_FIRST_DEGREE = 12
_FEW, _FEW_ROWS = 4, 500  # the first dynamics rest on every fourth row, in blocks
_BENDS_DEGREE = 18  # of the choice that first says where the curve bends
_ALWAYS = 13  # ordinates: stiffness holds those of a dead zone and two slopes between few phases
_A_LEVEL = 4  # ordinates, where what is between them is held too


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

    @property
    def free(self) -> bool:
        """Whether the user asks for other orders than those of a lag with a dead time."""
        return self.na != 1 or self.nb is not None

    @property
    def n_inputs(self) -> int:
        """Past inputs, as asked for or as a lag with a dead time has them."""
        return 2 if self.nb is None else self.nb

    @property
    def given_deg(self) -> Array | None:
        """The knots given, shape (d + 1,)."""
        return None if self.knots_deg is None else np.array(self.knots_deg, dtype=np.float64)


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
                rows.levels,
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
            alike = fit_from_afar(Projected(stretches, self.rough.family, start, counted, priors))
            alike = or_sampled(alike)
        return alike.reweighted(bisquare_weights(alike, residual_scales(alike)), priors)


def rough_fit(data: Dataset, part: Dataset, options: FastOptions) -> Projected:
    """Return a first fit, to the knots given or to even ones.

    Parameters
    ----------
    data
        All samples.
    part
        Those to fit.
    options
        What is fixed.

    Raises
    ------
    InputError
        The data cannot carry the model.
    """
    even = [_even_knots_deg(part, k, options) for k in range(len(part.points))]
    few = thinned(data, part.n // _FEW, _FEW_ROWS)
    family, start = first_dynamics(few, even, options.na, options.n_inputs, free=options.free)
    knots_deg = even if options.given_deg is None else [options.given_deg] * len(even)
    stretches = build_design(part, knots_deg)
    alike, priors = counted_alike(stretches), soft_priors(part, knots_deg)
    return robust_fit(Projected(stretches, family, start, alike, priors)).problem


def settle_shape(part: Dataset, rough: Projected, options: FastOptions) -> Shape:
    """Settle what the user left open, on held-out samples.

    Parameters
    ----------
    part
        The samples to settle it on.
    rough
        The first fit to them, which has refused those that cannot carry the model.
    options
        What is fixed.
    """
    points = range(len(part.points))
    settled = [_settled(part, k, rough, options) for k in points]
    choices, rows = zip(*settled, strict=True)
    return Shape(rough, options.knots_deg is not None, choices, rows)


def _even_knots_deg(data: Dataset, point: int, options: FastOptions) -> Array:
    """Knots of a first curve."""
    degree = min(_FIRST_DEGREE, max(_degrees(data, point, options)))
    return place_knots(*data.spans_deg[point], degree)


def _degrees(data: Dataset, point: int, options: FastOptions) -> tuple[int, ...]:
    """Degrees to choose from that the data can carry."""
    if options.knots_deg is not None:
        degrees: tuple[int, ...] = (len(options.knots_deg) - 1,)
    elif options.degree is not None:
        degrees = (options.degree,)
    else:
        phases = np.unique(data.phase_deg(point)).size
        degrees = tuple(d for d in DEGREES if d < max(phases, _ALWAYS))
    check_rows(data, min(degrees), options.na, options.n_inputs, point=point)
    return degrees


def _settled(
    data: Dataset, point: int, rough: Projected, options: FastOptions
) -> tuple[Choice, CurveRows]:
    """Choose a point's curve, and say on which samples."""
    rows = curve_rows(data, point, rough)
    if options.given_deg is not None:
        return judge_knots(rows, options.given_deg), rows
    degrees, span_deg = _degrees(data, point, options), data.spans_deg[point]
    smooth = _between_levels(rows, _smooth(rows, degrees, span_deg), degrees, span_deg)
    if rows.dynamics is NONE:
        smooth = _gliding(block_rows(data, point, rough), smooth, degrees, span_deg) or smooth
    return jumping_choice(data, point, rough, smooth, degrees) or smooth


def _between_levels(
    rows: CurveRows,
    free: Choice,
    degrees: tuple[int, ...],
    span_deg: tuple[float, float],
) -> tuple[Choice, CurveRows]:
    """Choose a curve again where few phases were driven and it does not stay between them."""
    curve = fitted_curve(rows, free)
    levels = Levels.of(np.concatenate(rows.phase_deg), curve)
    if levels.phase_deg.size > LEVELS or levels.holds(curve):
        return free, rows
    held = replace(rows, levels=levels)
    if len(degrees) > 1:
        most = max(_A_LEVEL * levels.phase_deg.size, _ALWAYS)
        degrees = tuple(d for d in DEGREES if d < most)
    return _smooth(held, degrees, span_deg), held


def _gliding(
    rows: CurveRows,
    held: tuple[Choice, CurveRows],
    degrees: tuple[int, ...],
    span_deg: tuple[float, float],
) -> tuple[Choice, CurveRows] | None:
    """Choose a curve on blocks of the record where it also glides between the dwells.

    A few levels do not tell where a curve bends between them. None where it glides nowhere, or the
    curve that the dwells chose is as good there.
    """
    if np.unique(np.concatenate(rows.phase_deg)).size <= LEVELS:
        return None
    gliding, choice = _smooth(rows, degrees, span_deg), held[0]
    as_it_is = judge_knots(rows, choice.knots_deg, (choice.stiffness,))
    return (gliding, rows) if better(gliding, as_it_is) else None


def _smooth(rows: CurveRows, degrees: tuple[int, ...], span_deg: tuple[float, float]) -> Choice:
    """Choose a curve twice: the first choice may say better where it bends."""
    middling = min(degrees, key=lambda degree: abs(degree - _BENDS_DEGREE))
    bends_deg = bends_of_rows(rows, span_deg)
    first = choose_curve(rows, (middling,), bends_deg, span_deg)
    better_deg = joined(bends_deg, bends_of_curve(fitted_curve(rows, first)), span_deg)
    if len(degrees) == 1 and better_deg == bends_deg:
        return first
    return choose_curve(rows, degrees, better_deg, span_deg)
