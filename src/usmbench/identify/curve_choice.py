"""How a point's curve is chosen: smooth, between few levels, from glides, or with jumps."""

from dataclasses import replace

import numpy as np

from usmbench.identify.bends import bends_of_curve, bends_of_rows, joined
from usmbench.identify.between_levels import Levels
from usmbench.identify.curve_rows import CurveRows, block_rows, curve_rows
from usmbench.identify.data import Dataset
from usmbench.identify.dynamics import NONE
from usmbench.identify.jumping_curve import jumping_choice
from usmbench.identify.like_phases import LEVELS
from usmbench.identify.projected import Projected
from usmbench.identify.selection import (
    DEGREES,
    Choice,
    better,
    choose_curve,
    fitted_curve,
    judge_knots,
)

_BENDS_DEGREE = 18  # of the choice that first says where the curve bends
_ALWAYS = 13  # ordinates: stiffness holds those of a dead zone and two slopes between few phases
_A_LEVEL = 4  # ordinates, where what is between them is held too


def degrees_for(n_phases: int, a_phase: int = 1) -> tuple[int, ...]:
    """Return the degrees that so many phases can carry, rising.

    Parameters
    ----------
    n_phases
        Phases that were driven.
    a_phase
        Ordinates at most for each.
    """
    return tuple(d for d in DEGREES if d < max(a_phase * n_phases, _ALWAYS))


def chosen_curve(
    data: Dataset, point: int, rough: Projected, degrees: tuple[int, ...]
) -> tuple[Choice, CurveRows]:
    """Choose a point's curve, and say on which samples.

    Parameters
    ----------
    data
        The samples.
    point
        Index of the operating point.
    rough
        A first fit to them.
    degrees
        Degrees to choose from, rising.
    """
    rows, span_deg = curve_rows(data, point, rough), data.spans_deg[point]
    smooth = _between_levels(rows, _smooth(rows, degrees, span_deg), degrees, span_deg)
    if rows.dynamics is NONE:
        smooth = _gliding(block_rows(data, point, rough), smooth, degrees, span_deg) or smooth
    return jumping_choice(data, point, rough, smooth, degrees) or smooth


def _between_levels(
    rows: CurveRows, free: Choice, degrees: tuple[int, ...], span_deg: tuple[float, float]
) -> tuple[Choice, CurveRows]:
    """Choose a curve again where few phases were driven and it does not stay between them."""
    curve = fitted_curve(rows, free)
    levels = Levels.of(np.concatenate(rows.phase_deg), curve)
    if levels.phase_deg.size > LEVELS or levels.holds(curve):
        return free, rows
    held = replace(rows, levels=levels)
    if len(degrees) > 1:
        degrees = degrees_for(levels.phase_deg.size, _A_LEVEL)
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
