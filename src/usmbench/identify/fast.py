"""The default method: separable start, output-error refinement, knots at the dead zone's edges."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.data import Dataset, from_windows
from usmbench.identify.design import Stretch, build_design, check_rows
from usmbench.identify.knots import dead_zone_deg, place_knots
from usmbench.identify.output_error import Dynamics, Fit, fit_output_error
from usmbench.identify.result import Identification, assemble
from usmbench.model.hammerstein import StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]

_ROBUST_ROUNDS = 4
_BISQUARE = 4.685  # 95 % efficiency at the normal distribution (Huber and Ronchetti, 2009)
_STANDING = 0.02  # share of the highest speed that counts as standing


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

    degree: int = 18
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
    degree = options.degree if options.knots_deg is None else len(options.knots_deg) - 1
    for point in range(len(data.points)):
        check_rows(data, degree, options.na, nb, point=point)
    knots_deg = _first_knots(data, options, degree)
    stretches = build_design(data, knots_deg)
    fit = _robust_fit(stretches, Dynamics(np.zeros(options.na), np.zeros(nb), 0))
    if options.knots_deg is None:
        knots_deg = _refined_knots(knots_deg, fit, degree)
        stretches = build_design(data, knots_deg)
        fit = _robust_fit(stretches, fit.dynamics)
    return assemble(
        data,
        "fast",
        fit.dynamics.linear_part(data.window_s),
        [StaticCurve(k, d) for k, d in zip(knots_deg, fit.delta, strict=True)],
        fit_s=time.perf_counter() - started_s,
    )


def _first_knots(data: Dataset, options: FastOptions, degree: int) -> list[Array]:
    """Even knots over each operating point's phases, or the user's."""
    if options.knots_deg is not None:
        return [np.array(options.knots_deg, dtype=np.float64)] * len(data.points)
    spans = [data.phase_deg(point) for point in range(len(data.points))]
    return [place_knots(float(s.min()), float(s.max()), degree) for s in spans]


def _refined_knots(knots_deg: Sequence[Array], fit: Fit, degree: int) -> list[Array]:
    """Gather knots at the edges of each curve's dead zone."""
    refined = []
    for knots, delta in zip(knots_deg, fit.delta, strict=True):
        curve = StaticCurve(knots, delta)
        top = float(np.max(np.abs(curve.speed_rad_s(np.linspace(knots[0], knots[-1], 501)))))
        edges = [e for e in dead_zone_deg(curve, _STANDING * top) if e is not None]
        share = 0.6 if edges else 0.0
        width = 0.04 * (knots[-1] - knots[0])
        refined.append(
            place_knots(float(knots[0]), float(knots[-1]), degree, tuple(edges), share, width)
        )
    return refined


def _robust_fit(stretches: Sequence[Stretch], start: Dynamics) -> Fit:
    """Fit the free run, reweighting by Tukey's bisquare until the outliers have no say."""
    weights = [np.ones(s.speed_rad_s.size) for s in stretches]
    fit = fit_output_error(stretches, start, weights)
    for _ in range(_ROBUST_ROUNDS):
        residuals = [s.speed_rad_s - y for s, y in zip(stretches, fit.output_rad_s, strict=True)]
        scale = 1.4826 * float(np.median(np.abs(np.concatenate(residuals))))
        if scale == 0.0:
            break
        weights = [np.clip(1.0 - (r / (_BISQUARE * scale)) ** 2, 0.0, 1.0) for r in residuals]
        fit = fit_output_error(stretches, fit.dynamics, weights)
    return fit
