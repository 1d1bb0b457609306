"""The default method: separable start, output-error refinement, knots at the dead zone's edges."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.identify.data import Dataset, describe
from usmbench.identify.gather import from_windows
from usmbench.identify.lag_family import LagFamily
from usmbench.identify.no_dead_time import without_needless_dead_time
from usmbench.identify.polish import polished
from usmbench.identify.projected import Projected
from usmbench.identify.residual_tests import residual_tests
from usmbench.identify.result import Identification, assemble
from usmbench.identify.robust_fit import RobustFit, robust_fit
from usmbench.identify.run_gains import at_one_gain, far_off, run_gains
from usmbench.identify.shape import FastOptions, Shape, rough_fit, settle_shape
from usmbench.identify.thinning import searched_part
from usmbench.identify.torque_limit import limited_fit
from usmbench.identify.uncertainty import (
    Estimate,
    covariance,
    curve_intervals,
    dynamics_intervals,
)
from usmbench.identify.unfollowed import unfollowed
from usmbench.model.hammerstein import StaticCurve
from usmbench.runs.record import Record

__all__ = ["FastOptions", "identify_fast"]

Array = NDArray[np.float64]

_SEARCH_SHARE = 0.01  # of a long record: the better the curvature, the fewer passes over all
_GAIN_ROUNDS, _SAME_GAIN = 3, 2e-4  # no bench repeats better
_OTHER_GAIN = 2e-3  # that a curve may have followed
_MOST_GAIN = 0.2  # beyond it a run is not that of another day
_SEARCH_ROWS, _SEARCH_DWELLS = (3_000, 20_000), 600


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
    measured = from_windows(records)
    data, part, shape, search = _at_one_gain(measured, options)
    knots_deg = shape.knots_deg
    search, family = without_needless_dead_time(search)
    share = part.n / data.n
    priors = [np.sqrt(share) * prior for prior in shape.priors(data)]
    linearised = search.problem.linearised()
    best = polished(data, knots_deg, family, search, linearised, priors)
    lag = search.problem.family
    estimate = Estimate(lag, best, linearised, share)
    # A torque limit is simulated through windows' averages; beside it a dead time may be another.
    if isinstance(lag, LagFamily) and not lag.sampled:
        estimate = limited_fit(search, lag, best) or estimate
    curves = [StaticCurve(k, d) for k, d in zip(knots_deg, best.delta, strict=True)]
    spread = covariance(estimate, priors)
    intervals = {
        **dynamics_intervals(estimate, spread, data.window_s),
        "points": [curve_intervals(c, r) for c, r in zip(curves, spread.delta, strict=True)],
    }
    found = assemble(
        measured,
        "fast",
        estimate.found.dynamics.linear_part(data.window_s),
        curves,
        intervals=intervals,
        colour=spread.noise_coefficients,
        tests=residual_tests(
            estimate.linearised, estimate.found.parameters.size, spread.noise_coefficients
        ),
    )
    warnings = (*data.warnings, *_few_phases(part, knots_deg), *unfollowed(part, search))
    return replace(found, warnings=warnings, fit_s=time.perf_counter() - started_s)


@dataclass(frozen=True, slots=True)
class _Runs:
    """All samples and those to search on, without the gains that the runs have of their own."""

    measured: Dataset
    some: Dataset
    gains: Array

    @property
    def data(self) -> Dataset:
        """All samples, at one gain."""
        return at_one_gain(self.measured, self.gains)

    @property
    def part(self) -> Dataset:
        """Samples to search on, at one gain."""
        return at_one_gain(self.some, self.gains)

    def further(self, problem: Projected) -> Array:
        """Return what gain a fit to the samples to search on still shows of each run."""
        return run_gains(problem, [s.run for s in self.some.segments])

    def also(self, further: Array) -> "_Runs":
        """Return the runs with further gains taken out; what is far off is an outlier at first."""
        gains = (1.0 + self.gains) * (1.0 + further) - 1.0
        return replace(self, gains=np.clip(gains, -_MOST_GAIN, _MOST_GAIN))


def _at_one_gain(
    measured: Dataset, options: FastOptions
) -> tuple[Dataset, Dataset, Shape, RobustFit]:
    """Return all samples and those to search on without the runs' own gains, and fits to these.

    A rough curve takes part of what it misses for a gain: the fine one has the last word.
    """
    some = searched_part(measured, _search_rows(measured))
    runs = _Runs(measured, some, np.zeros(1 + max(s.run for s in some.segments)))
    rounds = _GAIN_ROUNDS if runs.gains.size > 1 else 0
    rough = rough_fit(measured, some, options)
    for _ in range(rounds):
        further = runs.further(rough)
        if np.max(np.abs(further)) < _SAME_GAIN:
            break
        runs = runs.also(further)
        rough = rough_fit(runs.data, runs.part, options)
    shape = settle_shape(runs.part, rough, options)
    search = robust_fit(shape.problem(runs.part))
    for _ in range(rounds):
        further = runs.further(search.problem)
        if np.max(np.abs(further)) < _SAME_GAIN:
            break
        runs = runs.also(further)
        if np.max(np.abs(further)) > _OTHER_GAIN:
            shape = settle_shape(runs.part, rough, options)
        search = robust_fit(shape.problem(runs.part))
    warnings = (*measured.warnings, *far_off(measured.runs, runs.gains))
    return replace(runs.data, warnings=warnings), runs.part, shape, search


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
