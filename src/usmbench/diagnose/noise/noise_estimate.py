"""The noise of a free-running residual estimated, with medians and trimmed means."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from usmbench.diagnose.cutting.dead_zone import dead_zone_deg
from usmbench.diagnose.cutting.stretches import Mask, Stretch
from usmbench.diagnose.noise.colour import taken_by_fit
from usmbench.diagnose.noise.levels import levels
from usmbench.diagnose.noise.noise_model import (
    KINDS,
    LAGS,
    STARTS,
    Noise,
    farther_out,
    runs_out,
    stands_below_rad_s,
    step_kind,
    turns,
)
from usmbench.diagnose.noise.spikes import whole_count_rad_s
from usmbench.identify.noise import autoregression
from usmbench.identify.robust_fit import OVER_MEDIAN

Array = NDArray[np.float64]

_SIZES, _FEWEST_OF_SIZE = 4, 8
_HIGHEST_ORDER = 6
_AT_REST = 1e-3  # of the highest speed: of a rotor that creeps, single counts are seen
_TRIMMED = 1.2  # what is left out above 97 % of a normal variable, and a little for heavier tails
_FEWEST_STARTS, _FEWEST_PAIRS, _FEWEST_QUIET = 20, 100, 50  # rows
# Of the speed up to which a rotor counts as standing: less is not worth while, more tells the noise
# of one that runs out. Nothing measured sets either.
_RUNS_OUT, _MOSTLY = 0.1, 0.5
_QUARTERS = 4  # of the phases: the fewest that tell near and far from the dead zone on both sides
_QUIET_SHARE, _NO_STEP_RAD_S = 0.2, 1e-9  # of the rows of a rotor that turns
_CALM, _FEWEST_CALM = 0.9, 500  # of the level; rows
_FAR = 4.0  # times the noise: what is farther out counts as that far
_AS_STATED = 1.2  # times: what a model states is rounded, and an estimate off by a tenth


def estimate_noise(
    stretches: Sequence[Stretch],
    residuals: Sequence[Array],
    masks: Sequence[Mask],
    fitted: Sequence[Array] | None = None,
) -> Noise:
    """Estimate the noise from residuals, with medians that spikes do not move.

    Parameters
    ----------
    stretches
        The stretches.
    residuals
        What is left on each, in rad/s.
    masks
        Rows that count.
    fitted
        Columns that were fitted to these very rows, in their standard deviations in rad/s, shape
        (N, K) a stretch; None where the residuals are those of other runs than the fit.
    """
    phase_deg = np.concatenate([s.context.phase_deg for s in stretches])
    error, quiet = np.concatenate(list(residuals)), _quiet(stretches, np.concatenate(list(masks)))
    centres, sigma = levels(phase_deg[quiet], error[quiet], _dead_zone_deg(stretches))
    none = np.zeros((LAGS, KINDS, _SIZES))
    flat = Noise(
        centres, sigma, np.empty(0), 1.0, none, none, np.zeros(len(STARTS)), np.zeros(LAGS)
    )
    flat = replace(flat, running_out=_running_out(stretches, residuals, masks, flat))
    sizes, spreads = _after_steps(stretches, residuals, masks, flat)
    flat = replace(flat, step_rad_s=sizes, step_spread_rad_s=spreads)
    flat = replace(flat, start_rad_s=_at_edge(stretches, residuals, masks, flat))
    flat = replace(flat, same_again=_returning(stretches, residuals, masks, flat))
    ar, innovation = _colour(stretches, residuals, masks, flat, fitted)
    return replace(flat, ar=ar, innovation=innovation)


def _quiet(stretches: Sequence[Stretch], use: Mask) -> Mask:
    """Rows that show the noise alone, of a rotor that turns, too: far from steps, or after little.

    Where a phase glides, the few rows at its crest, those of a rotor at rest, and those of a
    warm-up at one phase say too little. A rotor that runs out in the dead zone has not the noise of
    one that stands there.
    """
    lag = np.concatenate([s.lag for s in stretches])
    size = np.concatenate([np.abs(s.step_rad_s) for s in stretches])
    use = use & ~np.concatenate([runs_out(s) > _RUNS_OUT for s in stretches])
    turning = use & np.concatenate([turns(s) for s in stretches])
    n_turning = max(int(np.count_nonzero(turning)), 1)
    far = use & ((lag >= LAGS) | (size < _NO_STEP_RAD_S))
    if _at_all_phases(stretches, far & turning, turning):
        return far
    near = use & (lag >= min(2, int(lag[use].max(initial=0))))
    if np.count_nonzero(near & turning) >= max(_FEWEST_QUIET, _QUIET_SHARE * n_turning):
        return near
    share = min(max(_QUIET_SHARE, _FEWEST_QUIET / n_turning), 1.0)
    small = turning & (size <= np.quantile(size[turning], share)) if turning.any() else use
    return np.asarray(far | near | small)


def _at_all_phases(stretches: Sequence[Stretch], rows: Mask, turning: Mask) -> bool:
    """Whether there are rows enough in each quarter of those of a rotor that turns, by phase."""
    phase_deg = np.concatenate([s.context.phase_deg for s in stretches])
    quarters = np.array_split(np.flatnonzero(turning)[np.argsort(phase_deg[turning])], _QUARTERS)
    fewest = min(int(np.count_nonzero(rows[quarter])) for quarter in quarters)
    return _QUARTERS * fewest >= _FEWEST_QUIET


def _dead_zone_deg(stretches: Sequence[Stretch]) -> tuple[float, float]:
    """Lowest and highest phase at which the rotor stands at every operating point."""
    phase_deg = np.concatenate([s.context.phase_deg for s in stretches])
    size_deg = np.concatenate([dead_zone_deg(s, _AT_REST) for s in stretches])
    low, high = (
        float(np.min(size_deg[way * phase_deg > 0.0], initial=180.0)) for way in (-1.0, 1.0)
    )
    return -low, high


def _running_out(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> float:
    """Share of a turning rotor's noise in one that runs out, past the window of the stop itself."""
    shares = []
    for s, error, mask in zip(stretches, residuals, masks, strict=True):
        still = (s.lag > 0) | (np.abs(s.step_rad_s) < stands_below_rad_s(s))
        rows = mask & still & (runs_out(s) > _MOSTLY)
        shares.append(np.abs(error[rows]) / flat.last_driven_rad_s(s)[rows])
    share = np.concatenate(shares)
    return min(OVER_MEDIAN * float(np.median(share)), 1.0) if share.size >= _FEWEST_STARTS else 0.0


def _after_steps(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> tuple[Array, Array]:
    """Sizes of steps, and the residual's spread by these at each lag after each kind of step."""
    lag, size, kind, use, error, calm = (
        np.concatenate(columns)
        for columns in (
            [s.lag for s in stretches],
            [np.abs(s.step_rad_s) for s in stretches],
            [step_kind(s) for s in stretches],
            masks,
            residuals,
            [flat.calm_rad_s(s) for s in stretches],
        )
    )
    sizes, spreads = np.ones((LAGS, KINDS, _SIZES)), np.zeros((LAGS, KINDS, _SIZES))
    use &= size > 2.0 * float(np.median(flat.sigma_rad_s))
    for k, c in np.ndindex(LAGS, KINDS):
        rows = use & (lag == k) & (kind == c)
        sizes[k, c], spreads[k, c] = _by_size(size[rows], error[rows], calm[rows])
    return sizes, spreads


def _by_size(size_rad_s: Array, error: Array, calm: Array) -> tuple[Array, Array]:
    """Sizes of steps, and the residual's spread there beyond that far from steps."""
    n_bins = min(size_rad_s.size // _FEWEST_OF_SIZE, _SIZES)
    if n_bins == 0:
        return np.zeros(_SIZES), np.zeros(_SIZES)
    sizes, spreads = [], []
    for rows in np.array_split(np.argsort(size_rad_s, kind="stable"), n_bins):
        square = error[rows] ** 2
        kept = float(np.mean(square[square <= np.quantile(square, 0.97)]))
        sizes.append(float(np.mean(size_rad_s[rows])))
        beyond = _TRIMMED * kept - float(np.mean(calm[rows] ** 2))
        spreads.append(np.sqrt(max(beyond, 0.0)))
    missing = _SIZES - n_bins
    rising = np.maximum.accumulate(sizes)  # means of equal sizes differ in their last digit
    return np.pad(rising, (missing, 0), mode="edge"), np.pad(spreads, (missing, 0), mode="edge")


def _at_edge(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> Array:
    """Residual's spread where the dead zone ends, beyond the noise's elsewhere."""
    rows = [mask & (s.lag > 0) for s, mask in zip(stretches, masks, strict=True)]
    share = np.concatenate([farther_out(s)[r] for s, r in zip(stretches, rows, strict=True)])
    square = np.concatenate([e[r] ** 2 for e, r in zip(residuals, rows, strict=True)])
    usual = np.concatenate(
        [flat.level_rad_s(s)[r] ** 2 for s, r in zip(stretches, rows, strict=True)]
    )
    nodes = np.array(STARTS)
    ends = np.r_[0.0, 0.5 * (nodes[1:] + nodes[:-1]), 1.5 * nodes[-1]]
    spreads = np.zeros(nodes.size)
    for k, (low, high) in enumerate(pairwise(ends)):
        near = (share > low) & (share <= high)
        if np.count_nonzero(near) >= _FEWEST_STARTS:
            kept = square[near] <= np.quantile(square[near], 0.98)
            beyond = float(np.mean(square[near][kept])) - float(np.mean(usual[near][kept]))
            spreads[k] = np.sqrt(max(beyond, 0.0))
    return spreads


def _returning(
    stretches: Sequence[Stretch], residuals: Sequence[Array], masks: Sequence[Mask], flat: Noise
) -> Array:
    """Correlation of the residual's parts after the same jump, by lag; 1 where none repeats."""
    found = np.ones(LAGS)
    for k in range(LAGS):
        pairs, alike, even = 0, 0.0, 0.0
        for s, error, mask in zip(stretches, residuals, masks, strict=True):
            rows = np.flatnonzero(mask & (s.lag == k) & (s.again > 1) & (s.step_rad_s != 0.0))
            same = s.jump[rows]
            unit = np.clip((error / flat.level_rad_s(s))[rows], -_FAR, _FAR)
            count, total, square = (
                np.bincount(same, w) for w in (np.ones(rows.size), unit, unit**2)
            )
            pairs += int(np.sum(count * (count - 1.0)))
            alike += float(np.sum(total**2 - square))
            even += float(np.sum((count - 1.0) * square))
        if pairs >= _FEWEST_PAIRS:
            found[k] = np.clip(alike / max(even, 1e-12), 0.0, 1.0)
    return found


def _colour(
    stretches: Sequence[Stretch],
    residuals: Sequence[Array],
    masks: Sequence[Mask],
    flat: Noise,
    fitted: Sequence[Array] | None,
) -> tuple[Array, float]:
    """Autoregression of the standardised residual, on rows that tell its colour and its size.

    Jitter has no colour, and a rotor that stands may have no noise, which would make that of one
    that turns seem less.
    """
    levels = [flat.level_rad_s(stretch) for stretch in stretches]
    calm = [flat.calm_rad_s(s) > _CALM * level for s, level in zip(stretches, levels, strict=True)]
    turning = [turns(s) for s in stretches]
    for telling in (turning, calm):
        fewer = [mask & rows for mask, rows in zip(masks, telling, strict=True)]
        if sum(int(np.count_nonzero(rows)) for rows in fewer) >= _FEWEST_CALM:
            masks = fewer
    moments = np.zeros(_HIGHEST_ORDER + 1)
    counts = np.zeros(_HIGHEST_ORDER + 1)
    for level, residual, mask in zip(levels, residuals, masks, strict=True):
        unit = residual / level
        unit = np.where(mask, np.clip(unit, -_FAR, _FAR), 0.0)
        for k in range(_HIGHEST_ORDER + 1):
            pairs = mask[k:] & mask[: mask.size - k]
            moments[k] += float(unit[k:] @ unit[: unit.size - k])
            counts[k] += np.count_nonzero(pairs)
    left = moments / np.maximum(counts, 1.0)
    if fitted is None:
        return autoregression(left, counts[0])
    rows = [f[m] / v[m, None] for f, v, m in zip(fitted, levels, masks, strict=True)]
    return autoregression(left + taken_by_fit(rows, left, counts[0]), counts[0])


def noise_as_stated(
    stretches: Sequence[Stretch],
    residuals: Sequence[Array],
    masks: Sequence[Mask],
    stated_rad_s: float,
) -> Noise:
    """Estimate a noise, no larger than a model states and counting adds.

    Of a run alone nobody knows what is noise: a hum that the model does not have looks like it. A
    window's counts are the difference of two angles, each off by anything within a count.

    Parameters
    ----------
    stretches, residuals, masks
        As in `estimate_noise`.
    stated_rad_s
        Standard deviation that the model states; 0 for none.
    """
    noise = estimate_noise(stretches, residuals, masks)
    if stated_rad_s <= 0.0:
        return noise
    counts = [s.context.count_rad_s or whole_count_rad_s(s) for s in stretches]
    counting_rad_s = max((c for c in counts if np.isfinite(c)), default=0.0) / np.sqrt(6.0)
    most_rad_s = _AS_STATED * float(np.hypot(stated_rad_s, counting_rad_s))
    calm = np.concatenate([noise.calm_rad_s(s)[s.use] for s in stretches])
    least = most_rad_s / max(float(np.sqrt(np.mean(calm**2))), 1e-12)
    return replace(noise, sigma_rad_s=min(least, 1.0) * noise.sigma_rad_s)
