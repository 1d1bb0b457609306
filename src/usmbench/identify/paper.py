"""The paper's algorithm: least squares for a, then Levenberg-Marquardt for b and δ.

Source: H. Mojallali, M. Ahmadi, Hammerstein Based Modeling of Traveling Wave Ultrasonic Motors,
2011. It works on settled pairs, about 40 of them, and from a random start.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from usmbench.errors import InputError
from usmbench.identify.data import Dataset, describe
from usmbench.identify.design import check_rows
from usmbench.identify.gather import from_pairs
from usmbench.identify.knots import place_knots
from usmbench.identify.paper_inverse_map import inverse_de_casteljau
from usmbench.identify.paper_lm import Lagged, LmOptions, LmResult, search
from usmbench.identify.result import Identification, assemble
from usmbench.model.bernstein import bernstein_basis
from usmbench.model.hammerstein import LinearPart, StaticCurve
from usmbench.runs.record import Record

Array = NDArray[np.float64]

# Section V, at 41 kHz and at 41.5 and 42 kHz.
KNOTS_BOTH_WAYS_DEG = (
    *(-90.0, -70.0, -50.0, -30.0, -20.0, -10.0, -5.0, -2.0, -1.0, 0.0),
    *(1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 50.0, 70.0, 90.0),
)
KNOTS_ONE_WAY_DEG = (0.0, 10.0, 20.0, 60.0, 65.0, 68.0, 70.0, 75.0, 80.0, 85.0, 90.0)


@dataclass(frozen=True, slots=True)
class PaperOptions:
    """What the user fixed.

    Parameters
    ----------
    degree
        Degree of the curves; None takes the paper's for the range of phases.
    knots_deg
        Knots of the curves; None takes the paper's, or even ones where the degree differs.
    na, nb
        Orders of the linear part.
    seed
        Seed of the random starts.
    search
        Settings of the search.
    """

    degree: int | None = None
    knots_deg: tuple[float, ...] | None = None
    na: int = 1
    nb: int = 0
    seed: int = 0
    search: LmOptions = field(default_factory=LmOptions)


@dataclass(frozen=True, slots=True)
class PaperIdentification:
    """A model by the paper's algorithm, with the search's trace.

    Parameters
    ----------
    found
        The identification.
    result
        The search.
    """

    found: Identification
    result: LmResult


def identify_paper(records: Sequence[Record], options: PaperOptions) -> PaperIdentification:
    """Identify a model from the settled pairs of one or several runs.

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
    data = from_pairs(records)
    rng = np.random.default_rng(options.seed)
    knots_deg = [_knots(span_deg, options) for span_deg in data.spans_deg]
    for k, knots in enumerate(knots_deg):
        check_rows(data, knots.size - 1, options.na, options.nb, point=k)
        _check_phases(data, knots.size - 1, k)
    blocks = _blocks(data, knots_deg, options, rng)
    a = _denominator(blocks, options)
    lagged = [Lagged(b.basis, b.speed_rad_s - b.past_rad_s @ a) for b in blocks]
    result = search(lagged, 1.0 + float(a.sum()), rng, options.search)
    linear = LinearPart(a, result.b, 0, data.window_s)
    curves = [StaticCurve(k, d) for k, d in zip(knots_deg, result.delta, strict=True)]
    found = assemble(data, "paper", linear, curves)
    found = replace(found, fit_s=time.perf_counter() - started_s)
    return PaperIdentification(found, result)


@dataclass(frozen=True, slots=True)
class _Block:
    """Rows of one operating point that have a whole past."""

    basis: Array
    speed_rad_s: Array
    past_rad_s: Array


def _blocks(
    data: Dataset, knots_deg: Sequence[Array], options: PaperOptions, rng: np.random.Generator
) -> list[_Block]:
    """Regressors of eq. (18b), one block an operating point."""
    first = max(options.na, options.nb)
    blocks = []
    for point, knots in enumerate(knots_deg):
        bases, speeds, pasts = [], [], []
        for segment in (s for s in data.segments if s.point == point and s.n > first):
            x, _ = inverse_de_casteljau(segment.phase_deg, knots, rng)
            basis = bernstein_basis(np.clip(x, 0.0, 1.0), knots.size - 1)
            n = segment.n
            lags = [basis[first - k : n - k] for k in range(options.nb + 1)]
            past = [-segment.speed_rad_s[first - i : n - i] for i in range(1, options.na + 1)]
            bases.append(np.stack(lags))
            speeds.append(segment.speed_rad_s[first:])
            pasts.append(np.column_stack(past) if past else np.empty((n - first, 0)))
        blocks.append(
            _Block(np.concatenate(bases, axis=1), np.concatenate(speeds), np.vstack(pasts))
        )
    return blocks


def _denominator(blocks: Sequence[_Block], options: PaperOptions) -> Array:
    """Least squares for â, eq. (17) to (19), by an orthogonal factorisation.

    The products of b and δ are eliminated point by point, which leaves the â of eq. (19).
    """
    if options.na == 0:
        return np.empty(0)
    pasts, speeds = [], []
    for block in blocks:
        lags = np.hstack(list(block.basis))
        left, singular, _ = np.linalg.svd(lags, full_matrices=False)
        span = left[:, singular > 1e-12 * singular[0]]
        pasts.append(block.past_rad_s - span @ (span.T @ block.past_rad_s))
        speeds.append(block.speed_rad_s - span @ (span.T @ block.speed_rad_s))
    a: Array = np.linalg.lstsq(np.vstack(pasts), np.concatenate(speeds), rcond=None)[0]
    if abs(1.0 + a.sum()) < 1e-6:
        raise InputError(
            "the least-squares stage found dynamics without a steady state (1 + Σa = 0); "
            "use --method fast, or --na 0"
        )
    return a


def _check_phases(data: Dataset, degree: int, point: int) -> None:
    """Refuse fewer phases than ordinates: from a random start the curve between them is random."""
    phases = np.unique(data.phase_deg(point)).size
    if phases < degree + 1:
        raise InputError(
            f"{data.name}: {phases} different phases{describe(data.points[point])} cannot carry "
            f"a curve of degree {degree}; lower --degree or measure more phases"
        )


def _knots(span_deg: tuple[float, float], options: PaperOptions) -> Array:
    """Take the user's knots, or the paper's where degree and range are those of Section V."""
    if options.knots_deg is not None:
        return np.array(options.knots_deg)
    low_deg, high_deg = span_deg
    published = KNOTS_ONE_WAY_DEG if low_deg >= 0.0 else KNOTS_BOTH_WAYS_DEG
    degree = len(published) - 1 if options.degree is None else options.degree
    covers = published[0] <= low_deg and high_deg <= published[-1]
    if degree == len(published) - 1 and covers:
        return np.array(published)
    return place_knots(low_deg, high_deg, degree)
