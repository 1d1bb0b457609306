"""What a fit settles before its numbers: family and start of the dynamics, knots, smoothness."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.curve_choice import chosen_curve, degrees_for
from usmbench.identify.curve_rows import CurveRows, curve_rows
from usmbench.identify.data import Dataset
from usmbench.identify.design import build_design, check_rows
from usmbench.identify.knots import place_knots
from usmbench.identify.prior_rows import prior_rows
from usmbench.identify.projected import Projected
from usmbench.identify.robust_fit import (
    bisquare_weights,
    counted_alike,
    residual_scales,
    robust_fit,
)
from usmbench.identify.selection import Choice, judge_knots
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
        degrees = degrees_for(np.unique(data.phase_deg(point)).size)
    check_rows(data, min(degrees), options.na, options.n_inputs, point=point)
    return degrees


def _settled(
    data: Dataset, point: int, rough: Projected, options: FastOptions
) -> tuple[Choice, CurveRows]:
    """Choose a point's curve, and say on which samples."""
    if options.given_deg is not None:
        rows = curve_rows(data, point, rough)
        return judge_knots(rows, options.given_deg), rows
    return chosen_curve(data, point, rough, _degrees(data, point, options))
