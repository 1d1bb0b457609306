"""Samples turned into regressors: the Bernstein basis over each segment's phases."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.identify.data import Dataset, describe
from usmbench.model.bernstein import bernstein_basis
from usmbench.model.inverse_map import bezier_abscissa

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Stretch:
    """One segment's regressors.

    Parameters
    ----------
    phase_deg
        Commanded phase, shape (n,).
    basis
        Bernstein basis at those phases, shape (n, d + 1).
    speed_rad_s
        Measured speed, shape (n,).
    point
        Index of the operating point.
    """

    phase_deg: Array
    basis: Array
    speed_rad_s: Array
    point: int


def build_design(data: Dataset, knots_deg: Sequence[Array]) -> tuple[Stretch, ...]:
    """Map every phase to its abscissa and evaluate the basis there.

    Parameters
    ----------
    data
        The samples.
    knots_deg
        Knots of each operating point's curve.

    Raises
    ------
    InputError
        A phase outside the knots, or knots that do not rise.
    """
    bases: list[Array] = [np.empty(0)] * len(data.segments)
    for point, knots in enumerate(knots_deg):
        mine = [k for k, s in enumerate(data.segments) if s.point == point]
        phases = [data.segments[k].phase_deg for k in mine]
        for k, basis in zip(mine, stacked_basis(phases, knots), strict=True):
            bases[k] = basis
    return tuple(
        Stretch(s.phase_deg, basis, s.speed_rad_s, s.point)
        for s, basis in zip(data.segments, bases, strict=True)
    )


def check_rows(data: Dataset, degree: int, na: int, nb: int, *, point: int) -> None:
    """Refuse an operating point with fewer rows than there are parameters.

    Parameters
    ----------
    data
        The samples.
    degree
        Degree of the curve.
    na, nb
        Orders of the linear part.
    point
        Index of the operating point.

    Raises
    ------
    InputError
        Too few, with the numbers, or none that follow each other.
    """
    wanted = degree + 1 + na + nb
    n, past = data.rows(point), max(na, nb)
    whole = sum(max(s.n - past, 0) for s in data.segments if s.point == point)
    if n >= wanted and whole == 0 and data.window_s is not None:
        raise InputError(
            f"{data.name}: no {past + 1} rows{describe(data.points[point])} follow each other: a "
            f"window is said to last {data.window_s:g} s, and rows are farther apart; check "
            "samples_per_average and sample_rate_hz of run.yaml, or the column window_s"
        )
    if n < wanted or whole == 0:
        rows = "settled pairs" if data.window_s is None else "rows"
        raise InputError(
            f"{data.name}: {n} {rows}{describe(data.points[point])} cannot carry "
            f"{wanted} parameters (degree {degree}, n_a {na}, n_b {nb}); lower --degree or "
            "measure more"
        )


def stacked_basis(phases_deg: Sequence[Array], knots_deg: Array) -> list[Array]:
    """Return the Bernstein basis at given phases of several stretches.

    Parameters
    ----------
    phases_deg
        Phases within the knots, shape (n_k,) each.
    knots_deg
        Knots, shape (d + 1,).

    Returns
    -------
    list of Array
        Shape (n_k, d + 1). Where dwells repeat a phase it is evaluated once.
    """
    phase_deg = np.concatenate(phases_deg)
    first = np.concatenate(([True], phase_deg[1:] != phase_deg[:-1]))
    distinct_deg = phase_deg[first]
    basis = bernstein_basis(bezier_abscissa(distinct_deg, knots_deg), knots_deg.size - 1)
    if distinct_deg.size < phase_deg.size:
        basis = basis[np.cumsum(first) - 1]
    return np.split(basis, np.cumsum([p.size for p in phases_deg])[:-1])
