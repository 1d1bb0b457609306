"""Where the search for the dynamics begins: their family, and a rough fit from afar."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.data import Dataset
from usmbench.identify.design import build_design
from usmbench.identify.dynamics import Dynamics, Family, FreeFamily
from usmbench.identify.lag_family import LONGER_DEAD_TIME, LagFamily
from usmbench.identify.output_error import fit_output_error
from usmbench.identify.prior_rows import prior_rows
from usmbench.identify.projected import Projected
from usmbench.identify.robust_fit import counted_alike, residual_scales
from usmbench.identify.separable import separable_start

Array = NDArray[np.float64]

_STIFFNESS = 1e-4
_ROUGHLY = 0.02  # of the sum of squares, where a search may stop
FINELY = 1e-3
"""The same, where it decides."""
PLAIN_DEVIANCE = 50.0
"""Deviance that dynamics of another kind have to take: a curve that misses a corner takes some."""
_PLAIN_SHARE = 0.03  # of the sum of squares, likewise
_DEAD_TIMES = range(6)


def first_dynamics(
    data: Dataset, knots_deg: Sequence[Array], na: int, nb: int, *, free: bool
) -> tuple[Family, Array]:
    """Return the family of dynamics to search in, and the parameters to start from.

    Parameters
    ----------
    data
        The samples.
    knots_deg
        Knots of each operating point's curve, shape (d + 1,) each.
    na, nb
        Orders of the linear part.
    free
        Whether its coefficients are free; else it is a lag with a dead time.
    """
    stretches = build_design(data, knots_deg)
    separable = separable_start(stretches, na, nb, _DEAD_TIMES)
    family, alike = _family(separable, free=free), counted_alike(stretches)
    start = family.parameters(separable)
    problem = Projected(stretches, family, start, alike, soft_priors(data, knots_deg))
    found = or_sampled(fit_from_afar(problem))
    return found.family, found.fit.parameters


def fit_from_afar(start: Projected) -> Projected:
    """Roughly fit the dynamics from here and from the best of lags short and long.

    Rows that a rough curve misses look like a lag of another length, or like a dead time.

    Parameters
    ----------
    start
        The problem, its parameters those to start from.
    """
    here = fit_output_error(start, _ROUGHLY)
    if not isinstance(start.family, LagFamily):
        return here
    others = [start.at(parameters) for parameters in start.family.starts()]
    best = min(others, key=lambda other: other.fit.sse)
    return min(here, fit_output_error(best, _ROUGHLY), key=lambda found: found.fit.sse)


def or_sampled(averaged: Projected) -> Projected:
    """Return the same problem for speeds at the ends of windows, where these plainly fit better.

    Other benches sample a tachometer, and simulations by the paper's equation have no windows.

    Parameters
    ----------
    averaged
        The problem, fitted to speeds that are averages over windows.
    """
    if not isinstance(averaged.family, LagFamily) or averaged.family.sampled:
        return averaged
    family, found = replace(averaged.family, sampled=True), averaged.fit.parameters
    start = family.moved(found, np.zeros_like(found))  # which is never too soon
    sampled = fit_output_error(
        Projected(averaged.stretches, family, start, averaged.weights, averaged.penalties),
        FINELY,
    )
    gained = averaged.fit.sse - sampled.fit.sse
    # Without noise there is no scale to speak of.
    mean_square = sampled.fit.sse / sum(s.speed_rad_s.size for s in sampled.stretches)
    square = min(min(residual_scales(sampled)) ** 2, mean_square)
    least = max(PLAIN_DEVIANCE * square, _PLAIN_SHARE * averaged.fit.sse)
    return sampled if gained > least else averaged


def soft_priors(data: Dataset, knots_deg: Sequence[Array]) -> list[Array]:
    """Return rows of prior knowledge of curves that nothing is known of yet.

    Parameters
    ----------
    data
        The samples.
    knots_deg
        Knots of each operating point's curve, shape (d + 1,) each.
    """
    return [
        prior_rows(knots, _STIFFNESS, None, data.rows(point))
        for point, knots in enumerate(knots_deg)
    ]


def _family(start: Dynamics, *, free: bool) -> Family:
    if free:
        return FreeFamily(start.a.size, start.beta.size, start.dead_time_windows)
    return LagFamily(start.dead_time_windows + LONGER_DEAD_TIME)
