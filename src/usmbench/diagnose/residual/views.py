"""The residual against what it may depend on: bins to look at, and a test over all of them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.stats import norm

from usmbench.diagnose.cutting.stretches import Stretch
from usmbench.diagnose.noise.colour import autocovariance
from usmbench.diagnose.residual.basis import Basis
from usmbench.diagnose.residual.problem import Problem
from usmbench.diagnose.result import View

Array = NDArray[np.float64]

_LAG_EDGES = np.array([0, 1, 2, 3, 4, 6, 10, 20, 40])
_PHASE_BINS, _TIME_BINS, _SPEED_BINS, _ANGLE_BINS = 16, 16, 12, 24
_MEMORY, _FORGOTTEN = 200, 0.01  # windows; of the noise's variance
LABELS = {
    "phase": "commanded phase φ (deg)",
    "direction": "phase φ (deg), half of what the residual differs by after rises and after falls",
    "time": "time (s)",
    "gain over time": "time (s), residual in the direction of motion",
    "lag": "windows after a step of φ, residual in the step's direction",
    "angle": "shaft angle (rad)",
    "speed": "simulated speed (rad/s)",
}


@dataclass(frozen=True, slots=True)
class Binning:
    """One view: a bin and a sign for every row.

    Parameters
    ----------
    versus
        Key of the view.
    centre
        Middle of each bin, shape (K,).
    index
        Bin of each row of each stretch; −1 for none.
    sign
        Factor on each row of each stretch.
    """

    versus: str
    centre: Array
    index: tuple[NDArray[np.int64], ...]
    sign: tuple[Array, ...]


def binnings(stretches: Sequence[Stretch]) -> list[Binning]:
    """Return the views that these runs allow.

    Parameters
    ----------
    stretches
        The runs.
    """
    ones = tuple(np.ones(s.context.n) for s in stretches)
    ways = tuple(np.sign(s.settled_rad_s) for s in stretches)
    phase = [s.context.phase_deg for s in stretches]
    times = [s.context.t_s for s in stretches]
    found = [
        _even("phase", phase, ones, _PHASE_BINS),
        _even("direction", phase, tuple(s.direction for s in stretches), _PHASE_BINS // 2),
        _even("time", times, ones, _TIME_BINS),
        _even("gain over time", times, ways, _TIME_BINS),
        _even("speed", [s.settled_rad_s for s in stretches], ones, _SPEED_BINS),
    ]
    after = [np.searchsorted(_LAG_EDGES, s.lag, side="right") - 1 for s in stretches]
    lag = tuple(np.where(i >= _LAG_EDGES.size - 1, -1, i) for i in after)
    middle = np.asarray(0.5 * (_LAG_EDGES[:-1] + _LAG_EDGES[1:] - 1), dtype=np.float64)
    found.append(Binning("lag", middle, lag, tuple(np.sign(s.step_rad_s) for s in stretches)))
    known = [s.context.angle_rad for s in stretches]
    angles = [np.mod(angle_rad, 2.0 * np.pi) for angle_rad in known if angle_rad is not None]
    if len(angles) == len(stretches):
        found.append(_even("angle", angles, ways, _ANGLE_BINS))
    return found


def _even(versus: str, values: Sequence[Array], sign: tuple[Array, ...], n_bins: int) -> Binning:
    """Bins of equal width over the range of the values."""
    low, high = min(float(v.min()) for v in values), max(float(v.max()) for v in values)
    width = max(high - low, 1e-12) / n_bins
    index = tuple(np.clip(((v - low) / width).astype(np.int64), 0, n_bins - 1) for v in values)
    centre = np.asarray(low + width * (np.arange(n_bins) + 0.5), dtype=np.float64)
    return Binning(versus, centre, index, sign)


def omnibus(problem: Problem) -> Basis:
    """Return the directions that all views together look in.

    Parameters
    ----------
    problem
        The problem.
    """
    return Basis.of(_side_by_side([_directions(problem, b) for b in binnings(problem.stretches)]))


def _side_by_side(parts: list[Array]) -> Array:
    """Return columns beside each other, and empty the list: together they take as much memory."""
    ends = np.cumsum([part.shape[1] for part in parts])
    columns = np.empty((len(parts[0]), ends[-1]), order="F")
    for end in ends:
        part = parts.pop(0)
        columns[:, end - part.shape[1] : end] = part
    return columns


def _directions(problem: Problem, binning: Binning) -> Array:
    """Return the directions that one view looks in, shape (M, rank)."""
    parts = zip(*_columns(problem, binning), strict=True)
    return Basis.of(problem.carried([np.column_stack(part) for part in parts])).vectors


def _columns(problem: Problem, binning: Binning) -> Iterator[list[Array]]:
    """Yield the columns of a view, by stretch: the bins, and what belongs to them."""
    stretches = problem.stretches
    # A gain that changes shows in proportion to the speed.
    gained = binning.versus == "gain over time"
    signs = [s.simulated_rad_s for s in stretches] if gained else binning.sign
    pairs = list(zip(binning.index, signs, strict=True))
    for k in range(binning.centre.size):
        yield [(i == k) * w for i, w in pairs]
    if binning.versus == "lag":
        for k in range(binning.centre.size):
            yield [(i == k) * s.step_rad_s for i, s in zip(binning.index, stretches, strict=True)]
    if binning.versus == "angle":
        for harmonic in (1, 2, 3):
            for wave in (np.cos, np.sin):
                yield [
                    s.simulated_rad_s * wave(harmonic * np.asarray(s.context.angle_rad))
                    for s in stretches
                ]


def residual_views(problem: Problem, after: Sequence[Array], spread: float) -> tuple[View, ...]:
    """Return the views of the residual before and after an extension, the farthest out first.

    Parameters
    ----------
    problem
        The problem, whose residual is the one before.
    after
        The residual of each stretch with the extension.
    spread
        Standard deviation of the whitened noise.
    """
    level = [problem.noise.level_rad_s(s) for s in problem.stretches]
    background = problem.known.background(problem.stretches)
    found = [
        _view(problem, b, level, after, spread, background) for b in binnings(problem.stretches)
    ]
    return tuple(sorted(found, key=lambda view: -view.excess_before))


def _view(
    problem: Problem,
    binning: Binning,
    level: Sequence[Array],
    after: Sequence[Array],
    spread: float,
    background: tuple[Sequence[Array], Array],
) -> View:
    """Average each bin's rows and work out the band that noise alone keeps within."""
    n_bins = binning.centre.size
    sums = np.zeros((3, n_bins))
    parts = zip(
        binning.index, binning.sign, problem.masks, problem.residual_rad_s, after, strict=True
    )
    for index, sign, mask, before, left in parts:
        rows = mask & (index >= 0) & (sign != 0.0)
        for k, values in enumerate((np.ones(mask.size), sign * before, sign * left)):
            sums[k] += np.bincount(index[rows], weights=values[rows], minlength=n_bins)
    count = np.maximum(sums[0], 1.0)
    known = _known_square(problem, binning, background) / count**2
    noise = spread**2 * _noise_square(problem, binning, level) / count**2
    seen = sums[0] >= 3
    # Every bin of the view together keeps within the band in 95 % of runs (Šidák).
    z = float(norm.ppf(0.5 + 0.5 * 0.95 ** (1.0 / max(int(seen.sum()), 1))))
    band = z * np.sqrt(np.where(seen, noise + known, 1.0))
    before, left = sums[1] / count, sums[2] / count
    excess = [float(np.max((np.abs(v) / band)[seen], initial=0.0)) for v in (before, left)]
    return View(
        binning.versus,
        LABELS[binning.versus],
        binning.centre[seen],
        before[seen],
        left[seen],
        band[seen],
        sums[0][seen],
        excess[0],
        excess[1],
    )


def _known_square(
    problem: Problem, binning: Binning, background: tuple[Sequence[Array], Array]
) -> Array:
    """Variance of each bin's sum by what is no news, in (rad/s)², shape (K,)."""
    shapes, root = background
    totals = np.zeros((binning.centre.size, root.shape[0]))
    parts = zip(binning.index, binning.sign, problem.masks, shapes, strict=True)
    for index, sign, mask, part in parts:
        rows = np.flatnonzero(mask & (index >= 0))
        shape = (totals.shape[0], mask.size)
        picked = csr_array((sign[rows], (index[rows], rows)), shape=shape)
        totals += np.asarray(picked @ part)
    square: Array = np.sum((totals @ root) ** 2, axis=1)
    return square


def _noise_square(problem: Problem, binning: Binning, level: Sequence[Array]) -> Array:
    """Variance of each bin's sum by the noise, whose colour ties rows, in (rad/s)², shape (K,)."""
    noise, square = problem.noise, np.zeros(binning.centre.size)
    colour = autocovariance(noise.ar, noise.innovation, _MEMORY if noise.ar.size else 0)
    last = int(np.max(np.flatnonzero(np.abs(colour) > _FORGOTTEN), initial=0))
    parts = zip(problem.stretches, binning.index, binning.sign, problem.masks, level, strict=True)
    for stretch, index, sign, mask, sigma in parts:
        at = np.maximum(index, 0)
        counts = np.where(mask & (index >= 0), sign, 0.0)
        square += np.bincount(at, (counts * sigma) ** 2, minlength=square.size)
        calm = counts * noise.calm_rad_s(stretch)
        for k in range(1, last + 1):
            pairs = calm[k:] * calm[:-k] * (at[k:] == at[:-k])
            square += 2.0 * colour[k] * np.bincount(at[k:], pairs, minlength=square.size)
    return square
